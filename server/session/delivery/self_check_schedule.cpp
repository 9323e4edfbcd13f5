#include "session/delivery/self_check_schedule.h"

#include "session/delivery/self_check.h"

namespace lpv {

SelfCheckSchedule::SelfCheckSchedule(WorkerPool& pool, std::chrono::seconds interval) : pool_(pool) {
  const MutexLock lock(state_->mutex);
  state_->interval = interval;
  state_->nextUnasked = Clock::now() + kUnaskedChecks * interval;
}

void SelfCheckSchedule::setInterval(std::chrono::seconds interval) {
  const MutexLock lock(state_->mutex);
  state_->interval = interval;
}

bool SelfCheckSchedule::unaskedDue(Clock::time_point now) {
  const MutexLock lock(state_->mutex);
  if (state_->interval.count() == 0 || now < state_->nextUnasked) return false;
  state_->nextUnasked = now + kUnaskedChecks * state_->interval;
  return true;
}

void SelfCheckSchedule::offer(const ScenePtr& scene, const VolumePtr& volume, Clock::time_point now) {
  {
    const MutexLock lock(state_->mutex);
    if (state_->interval.count() == 0 || state_->checking || now < state_->next) return;
    state_->checking = true;
    state_->next = now + state_->interval;
    state_->nextUnasked = now + kUnaskedChecks * state_->interval;
  }
  pool_.post([state = state_, scene, volume] {
    const std::optional<ErrorEstimate> found = selfCheck(*scene, *volume, std::uint32_t(scene->revision));
    const MutexLock lock(state->mutex);
    state->checking = false;
    state->measured =
        found ? std::optional(MeasuredError{found->error, found->low, found->high, scene->revision}) : std::nullopt;
  });
}

std::optional<MeasuredError> SelfCheckSchedule::measured() const {
  const MutexLock lock(state_->mutex);
  return state_->measured;
}

}  // namespace lpv
