#pragma once
// Everybody who is connected to the door.

#include <cstddef>
#include <list>
#include <memory>
#include <vector>

#include "base/mutex.h"
#include "base/timers.h"

namespace lpv::web_door {

/// A connection, seen from the door. Any thread.
class Guest {
 public:
  virtual ~Guest() = default;
  /// Closes it where no call is open.
  virtual void leaveIfIdle() = 0;
  virtual void leave() = 0;
  virtual void cut() = 0;
};

/// Everybody who is there. Thread-safe.
class Guests {
 public:
  /// Visits, connections that are no sockets (yet); one more, and the oldest is cut off.
  static constexpr std::size_t kMostVisits = 256;

  void add(const std::shared_ptr<Guest>& guest, bool visit);
  void remove(const Guest* guest);
  /// The oldest of the visits where there are too many.
  std::shared_ptr<Guest> tooMany();
  std::vector<std::shared_ptr<Guest>> all();
  /// Waits until nobody is there; false at the deadline.
  bool waitEmpty(Clock::time_point deadline);

 private:
  struct Entry {
    const Guest* address;
    std::weak_ptr<Guest> guest;
    bool visit;
  };
  Mutex mutex_;
  ConditionVariable gone_;
  std::list<Entry> guests_ LPV_GUARDED_BY(mutex_);
};

}  // namespace lpv::web_door
