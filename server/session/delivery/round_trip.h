#pragma once

#include <cmath>

namespace lpv {

/// How long a subscriber takes to acknowledge, and how far it strays from that: a running mean and mean deviation, as
/// TCP keeps them (RFC 6298, section 2).
class RoundTrip {
 public:
  /// An acknowledgement came `seconds` after its result was sent.
  void measured(double seconds) {
    if (mean_ == 0.0) {
      mean_ = seconds;
      deviation_ = 0.5 * seconds;
      return;
    }
    deviation_ += kDeviationGain * (std::abs(seconds - mean_) - deviation_);
    mean_ += kGain * (seconds - mean_);
  }
  /// Seconds; 0 before the first.
  double mean() const { return mean_; }
  double deviation() const { return deviation_; }

 private:
  static constexpr double kGain = 0.2;
  static constexpr double kDeviationGain = 0.25;

  double mean_ = 0.0;
  double deviation_ = 0.0;
};

}  // namespace lpv
