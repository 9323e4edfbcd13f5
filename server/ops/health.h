#pragma once

#include <atomic>
#include <string>
#include <vector>

#include "base/mutex.h"
#include "base/status.h"
#include "session/counters.h"
#include "session/damaged_sessions.h"
#include "session/journal.h"

namespace lpv::ops {

/// Liveness and readiness of the process. Thread-safe.
class Health {
 public:
  /// Consecutive failed ticks, over all sessions, after which the device counts as failed.
  static constexpr int kFailedTicks = 3;
  /// Time without a tick ending while one is running after which the server is not ready. Software devices are slow.
  static constexpr std::chrono::seconds kStalled{60};
  /// The same, or with the once-a-second sweep over all sessions hanging, after which the process should be restarted.
  static constexpr std::chrono::seconds kStuck{300};

  /// `counters` must outlive this.
  explicit Health(const Counters& counters) : counters_(counters) {}

  /// Marks the server as serving. `journal` is used until stopServing(); `damaged` outlives this.
  void serve(const Journal& journal, const DamagedSessions& damaged);
  void stopServing();

  /// Liveness. An error, with the reason, means that the process should be restarted.
  Status live() const;
  /// Readiness. An error, with the reason: starting, draining, device or state directory failed.
  Status ready() const;

  /// Something that operators should see to although the server serves; empty: no longer.
  void setWarning(const std::string& warning);
  /// That, and sessions that are damaged; a line each.
  std::vector<std::string> warnings() const;

 private:
  enum class State { kStarting, kServing, kDraining };

  const Counters& counters_;
  std::atomic<State> state_{State::kStarting};
  std::atomic<const Journal*> journal_{nullptr};
  std::atomic<const DamagedSessions*> damaged_{nullptr};
  mutable Mutex mutex_;
  std::string warning_ LPV_GUARDED_BY(mutex_);
};

}  // namespace lpv::ops
