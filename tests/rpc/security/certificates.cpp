#include "rpc/security/certificates.h"

#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/pem.h>
#include <openssl/x509v3.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace lpv::rpc {
namespace {

void require(bool worked) {
  if (!worked) throw std::runtime_error("OpenSSL did not make a certificate for a test");
}

EVP_PKEY* newKey() { return EVP_EC_gen("P-256"); }

void extend(X509* certificate, X509* issuer, int what, const char* value) {
  X509V3_CTX context;
  X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
  X509_EXTENSION* extension = X509V3_EXT_conf_nid(nullptr, &context, what, value);
  require(extension != nullptr && X509_add_ext(certificate, extension, -1) == 1);
  X509_EXTENSION_free(extension);
}

void setName(X509_NAME* out, const std::string& name) {
  require(X509_NAME_add_entry_by_txt(out, "CN", MBSTRING_UTF8, reinterpret_cast<const unsigned char*>(name.c_str()), -1,
                                     -1, 0) == 1);
}

std::string temporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "lpv-certificates-XXXXXX").string();
  if (!mkdtemp(pattern.data())) throw std::runtime_error("no temporary folder");
  return pattern;
}

}  // namespace

Authority::Authority(const std::string& name)
    : folder_(temporaryFolder()), name_(name), key_(newKey(), EVP_PKEY_free), certificate_(nullptr, X509_free) {
  require(key_ != nullptr);
  certificate_ = sign(name, key_.get(), 3600);
  std::FILE* out = std::fopen(file().c_str(), "w");
  require(out && PEM_write_X509(out, certificate_.get()) == 1 && std::fclose(out) == 0);
}

Authority::~Authority() { std::filesystem::remove_all(folder_); }

/// The first one is the authority's own, signed by itself.
Authority::Certificate Authority::sign(const std::string& name, EVP_PKEY* key, long secondsLeft) const {
  Certificate out(X509_new(), X509_free);
  X509* const x = out.get();
  X509* const issuer = certificate_ ? certificate_.get() : x;
  require(X509_set_version(x, 2) == 1);
  static long serial = 1;
  ASN1_INTEGER_set(X509_get_serialNumber(x), ++serial);
  X509_gmtime_adj(X509_getm_notBefore(x), -3600);
  X509_gmtime_adj(X509_getm_notAfter(x), secondsLeft);
  setName(X509_get_subject_name(x), name);
  require(X509_set_issuer_name(x, X509_get_subject_name(issuer)) == 1 && X509_set_pubkey(x, key) == 1);
  if (issuer == x) {
    extend(x, issuer, NID_basic_constraints, "critical,CA:TRUE");
  } else {
    extend(x, issuer, NID_subject_alt_name, "DNS:localhost,IP:127.0.0.1");
  }
  require(X509_sign(x, key_.get(), EVP_sha256()) > 0);
  return out;
}

CertificateFiles Authority::issue(const std::string& name, long secondsLeft) const {
  const Key key(newKey(), EVP_PKEY_free);
  const Certificate certificate = sign(name, key.get(), secondsLeft);
  const CertificateFiles files{folder_ + "/" + name + ".pem", folder_ + "/" + name + ".key"};
  std::FILE* out = std::fopen(files.certificate.c_str(), "w");
  require(out && PEM_write_X509(out, certificate.get()) == 1 && std::fclose(out) == 0);
  out = std::fopen(files.key.c_str(), "w");
  require(out && PEM_write_PrivateKey(out, key.get(), nullptr, nullptr, 0, nullptr, nullptr) == 1 &&
          std::fclose(out) == 0);
  return files;
}

std::string Authority::write(const std::string& name, const std::string& text) const {
  const std::string path = folder_ + "/" + name;
  std::ofstream(path) << text;
  return path;
}

}  // namespace lpv::rpc
