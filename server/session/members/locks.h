#pragma once
// Lights and surfaces that a member asks the others to leave alone for a while. Transient: in no log, forgotten with
// the process. A lock names an object, not a life of one: it is there before and after a deletion.

#include <chrono>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "base/status.h"
#include "base/timers.h"
#include "scene/edits.h"

namespace lpv {

/// Objects that one member can have locked at a time.
inline constexpr std::size_t kMaxLocks = 64;
inline constexpr std::chrono::seconds kMaxLockTime{60};

/// The locks of one session. Not thread-safe: the session's lock guards it.
class Locks {
 public:
  /// All of the names or none, until then; one's own are renewed. ABORTED where another has one of them,
  /// RESOURCE_EXHAUSTED (max_locks) where they become too many.
  Status lock(const std::string& client, const std::vector<std::string>& names, Clock::duration time,
              Clock::time_point now);
  /// Those of the names that are the member's; no names: all of its.
  void release(const std::string& client, const std::vector<std::string>& names);
  /// ABORTED, naming holder and time left, where another than `client` has the object.
  Status check(const std::string& client, const std::string& name, Clock::time_point now) const;
  /// The same of everything that an edit changes, at "operations[i]".
  Status check(const std::string& client, const Edit& edit, Clock::time_point now) const;
  /// Forgets what is over; says whose it was.
  std::set<std::string> expire(Clock::time_point now);

  std::vector<std::string> heldBy(const std::string& client) const;

 private:
  struct Lock {
    std::string client;
    Clock::time_point until;
  };
  std::map<std::string, Lock> locks_;
};

}  // namespace lpv
