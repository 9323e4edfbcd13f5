#pragma once

#include <algorithm>

#include "base/timers.h"

namespace lpv {

/// At most so many a second. They keep a beat: one that comes late, but by less than an interval, does not put off
/// those after it. So what is asked for at the rate itself, only not evenly, hardly waits. After a pause a new beat
/// begins.
class Pacer {
 public:
  /// None may begin earlier.
  Clock::time_point next() const { return next_; }
  /// One begins, `interval` being the reciprocal of the rate.
  void begin(Clock::time_point now, Clock::duration interval) {
    next_ = (now < next_ + interval ? next_ : now) + interval;
  }
  void postpone(Clock::time_point until) { next_ = std::max(next_, until); }

 private:
  Clock::time_point next_{};
};

}  // namespace lpv
