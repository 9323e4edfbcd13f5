#include "lpv/pacing/timeline.h"

#include <algorithm>
#include <utility>

namespace lpv {

void Timeline::add(const Pause& piece, double predicted, Clock::time_point begin, std::shared_ptr<StageClock> owner) {
  entries_.push_back({gpu::Fence::insert(), piece.stage, piece.units, predicted, begin, std::move(owner)});
}

const std::vector<Timeline::Ended>& Timeline::poll() {
  ended_.clear();
  auto entry = entries_.begin();
  for (; entry != entries_.end() && entry->fence.signalled(); ++entry) {
    const Clock::time_point now = Clock::now();
    const double seconds = std::chrono::duration<double>(now - std::max(entry->begin, lastEnd_)).count();
    entry->owner->add(entry->stage, seconds, entry->units);
    ended_.push_back({entry->owner, entry->stage, seconds, entry->predicted});
    lastEnd_ = now;
  }
  entries_.erase(entries_.begin(), entry);
  return ended_;
}

bool Timeline::holds(const StageClock& owner) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Entry& e) { return e.owner.get() == &owner; });
}

void Timeline::waitForOldest(std::chrono::microseconds atMost) const {
  if (!entries_.empty()) entries_.front().fence.wait(atMost);
}

}  // namespace lpv
