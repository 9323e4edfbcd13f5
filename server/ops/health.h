#pragma once

#include <atomic>

#include "base/status.h"
#include "session/counters.h"
#include "session/journal.h"

namespace lpv::ops {

/// Whether the process is worth keeping, and whether it should be sent clients. Any thread.
class Health {
 public:
  /// Ticks that fail one after the other, of whatever sessions, before the device counts as failed.
  static constexpr int kFailedTicks = 3;
  /// Without a tick ending although one is under way. The software device needs seconds for large scenes.
  static constexpr std::chrono::seconds kStalled{60};
  /// The same, and the once-a-second sweep over all sessions not through: only a new process helps.
  static constexpr std::chrono::seconds kStuck{300};

  /// `counters` outlive this.
  explicit Health(const Counters& counters) : counters_(counters) {}

  /// Clients are served from now on. `journal` is asked until stopServing().
  void serve(const Journal& journal);
  void stopServing();

  /// Not ok, with why, where the process should be ended.
  Status live() const;
  /// Not ok, with why, where clients should go elsewhere for now: starting, draining, device or state directory failed.
  Status ready() const;

 private:
  enum class State { kStarting, kServing, kDraining };

  const Counters& counters_;
  std::atomic<State> state_{State::kStarting};
  std::atomic<const Journal*> journal_{nullptr};
};

}  // namespace lpv::ops
