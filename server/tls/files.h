#pragma once

#include <string>

#include "base/status.h"

namespace lpv::tls {

/// Files in PEM form; all empty: plain text.
struct Files {
  std::string certificate;  ///< the server's, with the chain that vouches for it
  std::string key;          ///< its private key
  /// Who vouches for clients; given: a client without a certificate of theirs is refused.
  std::string clientAuthorities;

  bool given() const { return !certificate.empty() || !key.empty() || !clientAuthorities.empty(); }
};

/// Checks the files: they can be read to their ends, the key is the certificate's, each certificate of the chain is
/// signed by the next and valid now. Errors name the flag and the file.
Status check(const Files& files);

}  // namespace lpv::tls
