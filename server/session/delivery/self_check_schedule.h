#pragma once

#include <chrono>
#include <memory>
#include <optional>

#include "base/mutex.h"
#include "base/timers.h"
#include "base/worker_pool.h"
#include "scene/scene.h"
#include "scene/volume.h"
#include "session/state.h"

namespace lpv {

/// Self-check interval multiplier for sessions without volume readers.
inline constexpr int kUnaskedChecks = 6;

/// When a session's volume is measured (self_check.h), and what the last measurement found: at most one at a time, on a
/// worker, `interval` apart. Thread-safe; acquires no other lock.
class SelfCheckSchedule {
 public:
  /// An interval of 0: never.
  SelfCheckSchedule(WorkerPool& pool, std::chrono::seconds interval);
  void setInterval(std::chrono::seconds interval);

  /// Whether a volume is due that nobody asked for. True once for each time that it is.
  bool unaskedDue(Clock::time_point now);
  /// Measures `volume` of `scene`, where that is due.
  void offer(const ScenePtr& scene, const VolumePtr& volume, Clock::time_point now);
  /// What the last measurement found; null before it, and where there is no truth to measure against.
  std::optional<MeasuredError> measured() const;

 private:
  /// Outlives the schedule while a worker measures.
  struct State {
    Mutex mutex;
    std::chrono::seconds interval LPV_GUARDED_BY(mutex){0};
    Clock::time_point next LPV_GUARDED_BY(mutex);  ///< check of a volume that is there
    Clock::time_point nextUnasked LPV_GUARDED_BY(mutex);  ///< volume that is made for its check
    bool checking LPV_GUARDED_BY(mutex) = false;
    std::optional<MeasuredError> measured LPV_GUARDED_BY(mutex);
  };

  WorkerPool& pool_;
  std::shared_ptr<State> state_ = std::make_shared<State>();
};

}  // namespace lpv
