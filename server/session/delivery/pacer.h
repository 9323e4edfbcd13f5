#pragma once

#include <algorithm>

#include "base/timers.h"

namespace lpv {

/// At most so many a second on average. One that comes late does not put off those after it: the next may come as much
/// earlier. So what is asked for at the rate itself, only not evenly, waits for nothing (virtual scheduling with a
/// burst of one, as in ITU-T I.371).
class Pacer {
 public:
  /// None may begin earlier.
  Clock::time_point next() const { return next_; }
  /// One begins, `interval` being the reciprocal of the rate.
  void begin(Clock::time_point now, Clock::duration interval) { next_ = std::max(next_, now - interval) + interval; }
  void postpone(Clock::time_point until) { next_ = std::max(next_, until); }

 private:
  Clock::time_point next_{};
};

}  // namespace lpv
