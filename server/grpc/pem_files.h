#pragma once

#include <string>

#include "base/status.h"
#include "grpc/certificates.h"

namespace lpv::grpc_door {

/// The bytes of TlsFiles.
struct PemFiles {
  std::string certificate;
  std::string key;
  std::string clientAuthorities;
  bool operator==(const PemFiles&) const = default;
};

/// INVALID_ARGUMENT for a file that cannot be read.
Expected<PemFiles> readPemFiles(const TlsFiles& files);

/// What check() says of these bytes; `names` are for the messages.
Status checkPem(const TlsFiles& names, const PemFiles& files);

}  // namespace lpv::grpc_door
