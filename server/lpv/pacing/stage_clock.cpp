#include "lpv/pacing/stage_clock.h"

#include <algorithm>
#include <utility>

namespace lpv {

StageClock::StageClock(std::shared_ptr<CostModel> device)
    : device_(device != nullptr ? std::move(device) : std::make_shared<CostModel>()) {}

void StageClock::restart() {
  seconds_.fill(0.0);
  ran_.fill(false);
}

void StageClock::add(Stage stage, double seconds, double units) {
  const auto i = std::size_t(stage);
  seconds_[i] += seconds;
  ran_[i] = true;
  if (units <= 0.0) return;
  // The first sample also holds the compilation of programs; a later one that does must not make crumbs of what
  // follows. Else slower counts at once, faster only slowly: a piece that is too long hurts others, one too short costs
  // little.
  constexpr double kMostSlowdown = 4.0;
  if (samples_[i]++ == 0) return;
  device_->learn(stage, seconds, units);
  const double rate = seconds / units, known = secondsPerUnit_[i];
  secondsPerUnit_[i] =
      known == 0.0 ? rate : std::max(std::min(rate, kMostSlowdown * known), 0.75 * known + 0.25 * rate);
}

double StageClock::secondsPerUnit(Stage stage) const {
  const double own = secondsPerUnit_[std::size_t(stage)];
  return own == 0.0 ? device_->secondsPerUnit(stage) : own;
}

double StageClock::unitsFor(Stage stage, double target) const { return std::max(1.0, target / secondsPerUnit(stage)); }

}  // namespace lpv
