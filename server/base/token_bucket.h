#pragma once

#include <algorithm>

#include "base/timers.h"

namespace lpv {

/// So many a second, and as many at once after a pause; one as soon as it is due where that is less than one. Not
/// thread-safe.
class TokenBucket {
 public:
  TokenBucket(double perSecond, Clock::time_point now) : left_(most(perSecond)), counted_(now) {}

  /// Takes one, where one is left.
  bool take(double perSecond, Clock::time_point now) {
    const double elapsed = std::chrono::duration<double>(now - counted_).count();
    left_ = std::min(most(perSecond), left_ + elapsed * perSecond);
    counted_ = now;
    if (left_ < 1.0) return false;
    left_ -= 1.0;
    return true;
  }

 private:
  static double most(double perSecond) { return std::max(1.0, perSecond); }

  double left_;
  Clock::time_point counted_;
};

}  // namespace lpv
