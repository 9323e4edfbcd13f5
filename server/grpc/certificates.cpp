#include "grpc/certificates.h"

#include <grpcpp/security/tls_certificate_provider.h>
#include <grpcpp/security/tls_credentials_options.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include <cstdio>

namespace lpv::grpc_door {
namespace {

constexpr unsigned kLookEverySeconds = 1;

using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
using Certificate = std::unique_ptr<X509, void (*)(X509*)>;
using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;

Status wrong(const char* flag, const std::string& path, const std::string& what) {
  ERR_clear_error();
  return invalid(flag, std::string("--") + flag + " " + path + ": " + what);
}

/// `read` is PEM_read_X509 or PEM_read_PrivateKey.
template <typename T>
Expected<T*> readPem(const char* flag, const std::string& path, T* (*read)(std::FILE*, T**, pem_password_cb*, void*)) {
  const File file(std::fopen(path.c_str(), "re"), [](std::FILE* f) { return std::fclose(f); });
  if (!file) return wrong(flag, path, "cannot be read");
  // No passphrase is asked for at a terminal: a file that needs one is refused.
  const auto noPassphrase = [](char*, int, int, void*) { return 0; };
  T* const out = read(file.get(), nullptr, noPassphrase, nullptr);
  if (!out) return wrong(flag, path, "is no PEM file of that kind, or needs a passphrase");
  return out;
}

}  // namespace

Status check(const TlsFiles& files) {
  if (!files.given()) return {};
  if (files.certificate.empty() || files.key.empty()) {
    return invalid("tls-cert", "--tls-cert and --tls-key go together; give both, or none and no --tls-client-ca");
  }
  const Expected<X509*> read = readPem<X509>("tls-cert", files.certificate, PEM_read_X509);
  if (!read) return read.status();
  const Certificate certificate(*read, X509_free);
  const Expected<EVP_PKEY*> readKey = readPem<EVP_PKEY>("tls-key", files.key, PEM_read_PrivateKey);
  if (!readKey) return readKey.status();
  const Key key(*readKey, EVP_PKEY_free);
  if (X509_check_private_key(certificate.get(), key.get()) != 1) {
    return wrong("tls-key", files.key, "is not the key of the certificate in --tls-cert " + files.certificate);
  }
  if (X509_cmp_current_time(X509_get0_notAfter(certificate.get())) < 0) {
    return wrong("tls-cert", files.certificate, "the certificate has expired");
  }
  if (X509_cmp_current_time(X509_get0_notBefore(certificate.get())) > 0) {
    return wrong("tls-cert", files.certificate, "the certificate is not valid yet");
  }
  if (files.clientAuthorities.empty()) return {};
  const Expected<X509*> authority = readPem<X509>("tls-client-ca", files.clientAuthorities, PEM_read_X509);
  if (!authority) return authority.status();
  X509_free(*authority);
  return {};
}

std::shared_ptr<grpc::ServerCredentials> serverCredentials(const TlsFiles& files) {
  if (!files.given()) return grpc::InsecureServerCredentials();
  using grpc::experimental::FileWatcherCertificateProvider;
  grpc::experimental::TlsServerCredentialsOptions options(std::make_shared<FileWatcherCertificateProvider>(
      files.key, files.certificate, files.clientAuthorities, kLookEverySeconds));
  options.watch_identity_key_cert_pairs();
  if (files.clientAuthorities.empty()) {
    options.set_cert_request_type(GRPC_SSL_DONT_REQUEST_CLIENT_CERTIFICATE);
  } else {
    options.watch_root_certs();
    options.set_cert_request_type(GRPC_SSL_REQUEST_AND_REQUIRE_CLIENT_CERTIFICATE_AND_VERIFY);
  }
  return grpc::experimental::TlsServerCredentials(options);
}

}  // namespace lpv::grpc_door
