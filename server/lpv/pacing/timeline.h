#pragma once

#include <chrono>
#include <memory>
#include <vector>

#include "engine/stage.h"
#include "gpu/fence.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"

namespace lpv {

/// The pieces under way on the device, in the order of submission. A piece's time runs from its first command,
/// or from the end of the piece before it, to its fence.
class Timeline {
 public:
  using Clock = std::chrono::steady_clock;

  /// A piece that has ended, and what it was predicted to take, seconds.
  struct Ended {
    std::shared_ptr<StageClock> owner;
    Stage stage;
    double seconds;
    double predicted;
  };

  /// Marks the end of a piece that began at `begin`.
  void add(const Pause& piece, double predicted, Clock::time_point begin, std::shared_ptr<StageClock> owner);
  /// Takes note of what has ended, oldest first, and tells it, until it is called again; never waits.
  const std::vector<Ended>& poll();
  /// Waits at most this long for the oldest piece; poll() afterwards.
  void waitForOldest(std::chrono::microseconds atMost) const;
  std::size_t underway() const { return entries_.size(); }
  /// Whether a piece of this session is under way.
  bool holds(const StageClock& owner) const;

 private:
  struct Entry {
    gpu::Fence fence;
    Stage stage;
    double units;
    double predicted;
    Clock::time_point begin;
    std::shared_ptr<StageClock> owner;
  };
  std::vector<Entry> entries_;  ///< few, oldest first
  std::vector<Ended> ended_;
  Clock::time_point lastEnd_{};
};

}  // namespace lpv
