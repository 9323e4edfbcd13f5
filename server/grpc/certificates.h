#pragma once

#include <grpcpp/security/server_credentials.h>

#include <functional>
#include <memory>
#include <string>

#include "base/status.h"

namespace lpv::grpc_door {

/// Files in PEM form; all empty: plain text.
struct TlsFiles {
  std::string certificate;  ///< the server's, with the chain that vouches for it
  std::string key;          ///< its private key
  /// Who vouches for clients; given: a client without a certificate of theirs is refused.
  std::string clientAuthorities;

  bool given() const { return !certificate.empty() || !key.empty() || !clientAuthorities.empty(); }
};

/// Checks the files: they can be read to their ends, the key is the certificate's, each certificate of the chain is
/// signed by the next and valid now. Errors name the flag and the file.
Status check(const TlsFiles& files);

/// Told when the files have become unusable, and with OK when they are good again.
using OnTlsTrouble = std::function<void(const Status&)>;

/// Follows the files, looking every quarter of a second. What is good is copied into a private folder, which goes with
/// this, and put in place by one rename; gRPC reads it there, so it never sees half a change. What is bad for two looks
/// is told, and the last good files stay in use.
class Certificates {
 public:
  /// INVALID_ARGUMENT for files that check() refuses, UNAVAILABLE where no private folder can be made.
  static Expected<std::unique_ptr<Certificates>> follow(const TlsFiles& files, OnTlsTrouble onTrouble);
  ~Certificates();
  Certificates(const Certificates&) = delete;
  Certificates& operator=(const Certificates&) = delete;

  /// Connections made two seconds after a good change get the new files. Open connections stay as they are.
  std::shared_ptr<grpc::ServerCredentials> credentials() const;

 private:
  class Parts;
  explicit Certificates(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::grpc_door
