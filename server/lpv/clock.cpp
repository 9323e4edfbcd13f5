#include "lpv/clock.h"

#include <algorithm>

namespace lpv {

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
  const double rate = seconds / units, known = secondsPerUnit_[i];
  secondsPerUnit_[i] =
      known == 0.0 ? rate : std::max(std::min(rate, kMostSlowdown * known), 0.75 * known + 0.25 * rate);
}

double StageClock::unitsFor(Stage stage, double target, double first) const {
  const double perUnit = secondsPerUnit_[std::size_t(stage)];
  return perUnit == 0.0 ? first : std::max(1.0, target / perUnit);
}

void Timeline::add(const Pause& piece, Clock::time_point begin, std::shared_ptr<StageClock> owner) {
  entries_.push_back({gpu::Fence::insert(), piece.stage, piece.units, begin, std::move(owner)});
}

void Timeline::poll() {
  while (!entries_.empty() && entries_.front().fence.signalled()) {
    const Clock::time_point now = Clock::now();
    const Entry& entry = entries_.front();
    const Clock::time_point begin = std::max(entry.begin, lastEnd_);
    entry.owner->add(entry.stage, std::chrono::duration<double>(now - begin).count(), entry.units);
    lastEnd_ = now;
    entries_.pop_front();
  }
}

bool Timeline::holds(const StageClock& owner) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.owner.get() == &owner; });
}

void Timeline::waitForOldest(std::chrono::microseconds atMost) const {
  if (!entries_.empty()) entries_.front().fence.wait(atMost);
}

}  // namespace lpv
