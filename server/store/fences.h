#pragma once

#include <limits>
#include <map>
#include <string>

#include "base/status.h"
#include "store/saved.h"

namespace lpv::store {

/// Which changes of which sessions were not written because another server owned the session. Of each session the last
/// fence is remembered.
class Fences {
 public:
  /// Changes of the session from `position` on are not written; no-op where it is fenced already.
  void add(const std::string& session, Position position, const Status& why);
  /// Changes from `position` on are written again: the session was taken over under a new epoch.
  void lift(const std::string& session, Position position);

  /// Ok, or why changes of the session are not written now.
  Status now(const std::string& session) const { return at(session, kOpen - 1); }
  /// Ok, or why the session's change at `position` was not written.
  Status at(const std::string& session, Position position) const;

 private:
  static constexpr Position kOpen = std::numeric_limits<Position>::max();

  /// Positions from <= p < to.
  struct Fence {
    Position from = 0;
    Position to = kOpen;
    Status why;
  };
  std::map<std::string, Fence> fences_;
};

}  // namespace lpv::store
