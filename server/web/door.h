#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "api/call/context.h"
#include "base/status.h"
#include "tls/follower.h"
#include "web/files.h"
#include "web/origins.h"

namespace lpv::web_door {

/// Where the door for browsers is, and what it looks like.
struct DoorOptions {
  std::string address;  ///< "host:port", port 0 = any free one
  Origins origins;
  Files files;
  tls::Follower* certificates = nullptr;  ///< outlives the door; null: plain text
};

/// Serves the page, and calls over WebSockets at /ws (lpv/web/v1/socket.proto). Thread-safe.
class Door {
 public:
  /// Listens. UNAVAILABLE where that is not possible. `context` outlives the door.
  static Expected<std::unique_ptr<Door>> open(const api::Context& context, DoorOptions options);
  /// As shutdown() without patience.
  ~Door();
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  int port() const;
  /// Takes no more connections, and closes those whose calls have ended, at the deadline all. Returns when every call
  /// has ended.
  void shutdown(std::chrono::milliseconds patience);

 private:
  class Parts;
  explicit Door(std::unique_ptr<Parts> parts);
  std::unique_ptr<Parts> parts_;
};

}  // namespace lpv::web_door
