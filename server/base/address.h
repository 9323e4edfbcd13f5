#pragma once

#include <string>

#include "base/status.h"

namespace lpv {

/// A place to listen on.
struct HostPort {
  std::string host;  ///< an IPv4 or IPv6 address without brackets, or a name
  int port = 0;      ///< 0..65535; 0: any free one

  /// "127.0.0.1:80", "[::1]:80".
  std::string text() const;
};

/// Reads "HOST:PORT", "[IPV6]:PORT" or ":PORT", which is on 127.0.0.1. INVALID_ARGUMENT at `flag`, which the message
/// names as "--FLAG", for anything else.
Expected<HostPort> parseHostPort(const std::string& flag, const std::string& text);

/// "localhost", 127.0.0.0/8 and ::1.
bool isLoopback(const std::string& host);

}  // namespace lpv
