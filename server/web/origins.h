#pragma once

#include <set>
#include <string>

#include "base/status.h"

namespace lpv::web_door {

/// Which names a browser may know this door by: a page of another site must not reach it through the browser of
/// somebody who can (DNS rebinding, cross-site WebSockets). Hosts and origins are compared as RFC 6454 has them,
/// without default ports and in lower case.
class Origins {
 public:
  /// `listed`: "https://light.example.org, https://10.0.0.5:8443", beside the door's own address; empty for none.
  /// INVALID_ARGUMENT at web-origins for what is no list of origins.
  static Expected<Origins> read(const std::string& listed);

  /// Where a connection has reached the door, with its own numbers: "127.0.0.1:8080", "[::1]:8080".
  struct Local {
    std::string address;
    bool loopback = false;
    bool tls = false;
  };
  /// PERMISSION_DENIED unless the Host header names the door.
  Status checkHost(const std::string& host, const Local& local) const;
  /// PERMISSION_DENIED unless the Origin header, empty for none, is a page that this door has served, or a listed one.
  Status checkOrigin(const std::string& origin, const Local& local) const;

 private:
  std::set<std::string> origins_;  ///< "https://light.example.org"
  std::set<std::string> hosts_;  ///< theirs
};

}  // namespace lpv::web_door
