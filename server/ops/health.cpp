#include "ops/health.h"

#include <string>

namespace lpv::ops {
namespace {

Status unavailable(const std::string& why) { return {Code::kUnavailable, why}; }

std::chrono::seconds since(TickWatch::Clock::time_point when) {
  return std::chrono::duration_cast<std::chrono::seconds>(TickWatch::Clock::now() - when);
}

}  // namespace

void Health::serve(const Journal& journal, const DamagedSessions& damaged) {
  journal_ = &journal;
  damaged_ = &damaged;
  state_ = State::kServing;
}

void Health::stopServing() { state_ = State::kDraining; }

void Health::setWarning(const std::string& warning) {
  const MutexLock lock(mutex_);
  warning_ = warning;
}

std::vector<std::string> Health::warnings() const {
  std::vector<std::string> out;
  const DamagedSessions* damaged = damaged_;
  if (damaged != nullptr && damaged->count() > 0) out.push_back(damaged->warning());
  const MutexLock lock(mutex_);
  if (!warning_.empty()) out.push_back(warning_);
  return out;
}

Status Health::live() const {
  const std::chrono::seconds stalled = counters_.tickWatch.stalledFor(TickWatch::Clock::now());
  if (stalled > kStuck) return unavailable("device: no tick has ended for " + std::to_string(stalled.count()) + " s");
  const std::chrono::seconds unswept = since(counters_.lastSweep);
  if (state_ == State::kServing && unswept > kStuck) {
    return unavailable("sessions: the sweep over them has not finished for " + std::to_string(unswept.count()) + " s");
  }
  return {};
}

Status Health::ready() const {
  const State state = state_;
  if (state == State::kStarting) return unavailable("starting");
  if (state == State::kDraining) return unavailable("draining");
  const TickWatch& watch = counters_.tickWatch;
  if (watch.contextLost()) return unavailable("device: " + watch.lastFailure());
  const std::chrono::seconds stalled = watch.stalledFor(TickWatch::Clock::now());
  if (stalled > kStalled) return unavailable("device: no tick has ended for " + std::to_string(stalled.count()) + " s");
  if (const int failed = watch.failedInARow(); failed >= kFailedTicks) {
    return unavailable("device: the last " + std::to_string(failed) + " ticks failed: " + watch.lastFailure());
  }
  if (const Status writable = journal_.load()->available(); !writable.ok()) {
    return unavailable("state directory: " + writable.message());
  }
  return {};
}

}  // namespace lpv::ops
