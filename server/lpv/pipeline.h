#pragma once
// The story of a tick: physical stages in physical order.

#include <array>
#include <memory>

#include "engine/engine.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/session_state.h"

namespace lpv {

/// Units of every stage in a tick that makes everything but frames, as its pieces count them. Beside the story, so that
/// a stage is added to both.
std::array<double, kStages> unitsOf(const Workload& workload);

/// Every stage with its programs; one per device, on its GL thread.
class Pipeline {
 public:
  /// `pieceSeconds`: how long one piece of GPU work may take at most.
  explicit Pipeline(double pieceSeconds);
  ~Pipeline();
  Pipeline(const Pipeline&) = delete;
  Pipeline& operator=(const Pipeline&) = delete;

  /// Brings `session` to the request's scene and fills `result`. All three outlive the coroutine. A stage runs where
  /// its inputs differ from those of what it made last; a tick may be abandoned after any piece. Throws gpu::Failure.
  GpuTask tick(SessionState& session, const TickRequest& request, TickResult& result);

 private:
  struct Stages;
  std::unique_ptr<Stages> stages_;
};

}  // namespace lpv
