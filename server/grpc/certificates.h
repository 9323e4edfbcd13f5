#pragma once

#include <grpcpp/security/server_credentials.h>

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

/// Checks the files: they can be read, the key is the certificate's, the certificate is valid now. Errors name the flag
/// and the file.
Status check(const TlsFiles& files);

/// Credentials that follow the files: connections made a second after a file has changed get the new one. A pair that
/// does not go together, as while one file of it is replaced, leaves new connections refused until it does; move a
/// directory or a link that holds both. Open connections stay as they are.
std::shared_ptr<grpc::ServerCredentials> serverCredentials(const TlsFiles& files);

}  // namespace lpv::grpc_door
