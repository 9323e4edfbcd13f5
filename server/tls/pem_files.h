#pragma once

#include <string>

#include "base/status.h"
#include "tls/files.h"

namespace lpv::tls {

/// The bytes of Files.
struct PemFiles {
  std::string certificate;
  std::string key;
  std::string clientAuthorities;
  bool operator==(const PemFiles&) const = default;
};

/// INVALID_ARGUMENT for a file that cannot be read.
Expected<PemFiles> readPemFiles(const Files& files);

/// What check() says of these bytes; `names` are for the messages.
Status checkPem(const Files& names, const PemFiles& files);

}  // namespace lpv::tls
