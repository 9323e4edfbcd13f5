#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>

#include "engine/stage.h"
#include "lpv/pacing/cost_model.h"

namespace lpv {

/// How long one session's stages took, and how fast they go: what a tick reports and what the next piece's size is
/// predicted from. One per session; it outlives the pieces in flight.
class StageClock {
 public:
  /// `device`: what is known of it from all sessions; null where there is no other.
  explicit StageClock(std::shared_ptr<CostModel> device);
  StageClock() : StageClock(nullptr) {}

  /// Forgets the times, not the rates: a tick begins.
  void restart();
  void add(Stage stage, double seconds, double units);

  bool ran(Stage stage) const { return ran_[std::size_t(stage)]; }
  double seconds(Stage stage) const { return seconds_[std::size_t(stage)]; }
  /// What the session's last pieces took, or, while nothing has been measured, the device's.
  double secondsPerUnit(Stage stage) const;
  /// Units of `stage` that should take `target` seconds; at least 1.
  double unitsFor(Stage stage, double target) const;

 private:
  std::shared_ptr<CostModel> device_;
  std::array<double, kStages> seconds_{};
  std::array<bool, kStages> ran_{};
  std::array<double, kStages> secondsPerUnit_{};  ///< 0: not known
  std::array<std::uint64_t, kStages> samples_{};
};

/// How much a stage may queue before it gives the turn away.
struct Pacing {
  const StageClock* clock = nullptr;
  double target = 0.003;  ///< seconds a piece should take

  int unitsFor(Stage stage) const { return int(std::min(1e9, clock->unitsFor(stage, target))); }
};

}  // namespace lpv
