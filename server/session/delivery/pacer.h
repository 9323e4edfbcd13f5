#pragma once

#include <algorithm>

#include "base/timers.h"

namespace lpv {

/// At most so many a second. With slack one that comes late does not put off those after it: the next may come as much
/// earlier, by an interval at the most, so that what is asked for at the rate itself, only not evenly, waits for
/// nothing (virtual scheduling with a burst of one, as in ITU-T I.371). Without, two are never nearer than an interval.
class Pacer {
 public:
  enum class Slack { kNone, kAnInterval };
  explicit Pacer(Slack slack) : slack_(slack) {}

  /// None may begin earlier.
  Clock::time_point next() const { return next_; }
  /// One begins, `interval` being the reciprocal of the rate.
  void begin(Clock::time_point now, Clock::duration interval) {
    next_ = std::max(next_, slack_ == Slack::kNone ? now : now - interval) + interval;
  }
  void postpone(Clock::time_point until) { next_ = std::max(next_, until); }

 private:
  Slack slack_;
  Clock::time_point next_{};
};

}  // namespace lpv
