#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <thread>
#include <utility>

#include "base/mutex.h"

namespace lpv {

using Clock = std::chrono::steady_clock;

/// One thread that calls functions at given times. Functions must be short and must not throw.
class Timers {
 public:
  Timers();
  ~Timers() { stop(); }
  Timers(const Timers&) = delete;
  Timers& operator=(const Timers&) = delete;

  /// Drops what is not due and joins; later calls are dropped.
  void stop();
  /// Names a call that was asked for.
  using Key = std::pair<Clock::time_point, std::uint64_t>;
  Key at(Clock::time_point when, std::function<void()> call);
  /// Lets go of a call that has not begun, and of what it holds.
  void cancel(const Key& key);

 private:
  void run();

  Mutex mutex_;
  ConditionVariable wake_;
  std::map<Key, std::function<void()>> calls_ LPV_GUARDED_BY(mutex_);
  std::uint64_t last_ LPV_GUARDED_BY(mutex_) = 0;  ///< number in a key
  bool stopping_ LPV_GUARDED_BY(mutex_) = false;
  std::thread thread_;
};

}  // namespace lpv
