#include "tls/pem_files.h"

#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include <fstream>
#include <iterator>
#include <memory>
#include <vector>

namespace lpv::tls {
namespace {

using Memory = std::unique_ptr<BIO, int (*)(BIO*)>;
using Certificate = std::unique_ptr<X509, void (*)(X509*)>;
using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;

constexpr const char* kCertificateFlag = "tls-cert";
constexpr const char* kKeyFlag = "tls-key";
constexpr const char* kAuthoritiesFlag = "tls-client-ca";

Status wrong(const char* flag, const std::string& path, const std::string& what) {
  ERR_clear_error();
  return invalid(flag, std::string("--") + flag + " " + path + ": " + what);
}

Expected<std::string> contentOf(const char* flag, const std::string& path) {
  if (path.empty()) return std::string();
  std::ifstream file(path, std::ios::binary);
  std::string out{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) return wrong(flag, path, "cannot be read");
  return out;
}

Memory memoryOf(const std::string& text) { return {BIO_new_mem_buf(text.data(), int(text.size())), BIO_free}; }

/// No passphrase is asked for at a terminal: a file that needs one is refused.
int noPassphrase(char*, int, int, void*) { return 0; }

/// All certificates of a file, the server's own first.
Expected<std::vector<Certificate>> certificatesOf(const char* flag, const std::string& path, const std::string& text) {
  const Memory memory = memoryOf(text);
  std::vector<Certificate> out;
  while (X509* read = PEM_read_bio_X509(memory.get(), nullptr, noPassphrase, nullptr))
    out.emplace_back(read, X509_free);
  const bool atEnd = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
  if (out.empty()) return wrong(flag, path, "is no PEM file of certificates");
  if (!atEnd) return wrong(flag, path, "is cut off, or broken, after certificate " + std::to_string(out.size()));
  ERR_clear_error();
  return out;
}

Status checkDates(const X509& certificate, const std::string& path, std::size_t number) {
  const std::string which = number == 1 ? "the certificate" : "certificate " + std::to_string(number) + " of the chain";
  if (X509_cmp_current_time(X509_get0_notAfter(&certificate)) < 0)
    return wrong(kCertificateFlag, path, which + " has expired");
  if (X509_cmp_current_time(X509_get0_notBefore(&certificate)) > 0)
    return wrong(kCertificateFlag, path, which + " is not valid yet");
  return {};
}

Status checkChain(const std::vector<Certificate>& chain, const std::string& path) {
  for (std::size_t i = 0; i < chain.size(); ++i) {
    if (Status s = checkDates(*chain[i], path, i + 1); !s.ok()) return s;
    if (i == 0 || X509_check_issued(chain[i].get(), chain[i - 1].get()) == X509_V_OK) continue;
    return wrong(kCertificateFlag, path,
                 "certificate " + std::to_string(i + 1) + " of the chain has not signed the one before it");
  }
  return {};
}

Status checkKey(const Files& names, const std::string& text, X509& certificate) {
  const Key key(PEM_read_bio_PrivateKey(memoryOf(text).get(), nullptr, noPassphrase, nullptr), EVP_PKEY_free);
  if (!key) return wrong(kKeyFlag, names.key, "is no PEM file of a private key, or needs a passphrase");
  if (X509_check_private_key(&certificate, key.get()) == 1) return {};
  return wrong(kKeyFlag, names.key, "is not the key of the certificate in --tls-cert " + names.certificate);
}

}  // namespace

Expected<PemFiles> readPemFiles(const Files& files) {
  Expected<std::string> certificate = contentOf(kCertificateFlag, files.certificate);
  if (!certificate) return certificate.status();
  Expected<std::string> key = contentOf(kKeyFlag, files.key);
  if (!key) return key.status();
  Expected<std::string> authorities = contentOf(kAuthoritiesFlag, files.clientAuthorities);
  if (!authorities) return authorities.status();
  return PemFiles{std::move(*certificate), std::move(*key), std::move(*authorities)};
}

Status checkPem(const Files& names, const PemFiles& files) {
  const auto chain = certificatesOf(kCertificateFlag, names.certificate, files.certificate);
  if (!chain) return chain.status();
  if (Status s = checkKey(names, files.key, *chain->front()); !s.ok()) return s;
  if (Status s = checkChain(*chain, names.certificate); !s.ok()) return s;
  if (names.clientAuthorities.empty()) return {};
  return certificatesOf(kAuthoritiesFlag, names.clientAuthorities, files.clientAuthorities).status();
}

}  // namespace lpv::tls
