#pragma once
// Certificates for tests: an authority of its own, and what it vouches for.

#include <openssl/evp.h>
#include <openssl/x509.h>

#include <memory>
#include <string>

namespace lpv::rpc {

/// A certificate with its key, as files in PEM form.
struct CertificateFiles {
  std::string certificate;
  std::string key;
};

/// Signs for "localhost" and 127.0.0.1. Files go into a folder that goes with this.
class Authority {
 public:
  explicit Authority(const std::string& name);
  ~Authority();
  Authority(const Authority&) = delete;
  Authority& operator=(const Authority&) = delete;

  const std::string& folder() const { return folder_; }
  /// The authority's own certificate.
  std::string file() const { return folder_ + "/authority.pem"; }
  /// A certificate that is valid from an hour ago until `secondsLeft` from now.
  CertificateFiles issue(const std::string& name, long secondsLeft = 3600) const;
  /// A file with that text.
  std::string write(const std::string& name, const std::string& text) const;

 private:
  using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;
  using Certificate = std::unique_ptr<X509, void (*)(X509*)>;
  Certificate sign(const std::string& name, EVP_PKEY* key, long secondsLeft) const;

  std::string folder_;
  std::string name_;
  Key key_;
  Certificate certificate_;
};

}  // namespace lpv::rpc
