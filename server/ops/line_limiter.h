#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <utility>

#include "base/mutex.h"

namespace lpv::ops {

/// Limits the lines of one kind that are written in a stretch of time. Thread-safe.
class LineLimiter {
 public:
  using Clock = std::chrono::steady_clock;

  LineLimiter(int most, Clock::duration each) : most_(most), each_(each) {}

  /// Returns the number left out since the last one written; nothing if this one is to be left out too.
  std::optional<std::int64_t> take() {
    const MutexLock lock(mutex_);
    const Clock::time_point now = Clock::now();
    if (now - since_ >= each_) {
      since_ = now;
      written_ = 0;
    }
    if (written_ == most_) {
      ++leftOut_;
      return std::nullopt;
    }
    ++written_;
    return std::exchange(leftOut_, 0);
  }

 private:
  const int most_;
  const Clock::duration each_;
  Mutex mutex_;
  Clock::time_point since_ LPV_GUARDED_BY(mutex_){};
  int written_ LPV_GUARDED_BY(mutex_) = 0;
  std::int64_t leftOut_ LPV_GUARDED_BY(mutex_) = 0;
};

}  // namespace lpv::ops
