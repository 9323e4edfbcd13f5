#pragma once
// The story of a tick: physical stages in physical order.

#include "engine/engine.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/shading.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/readback.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/session_state.h"
#include "lpv/transport/gather.h"
#include "lpv/transport/inject.h"
#include "lpv/transport/propagate.h"
#include "lpv/transport/volume.h"
#include "lpv/voxelize/voxelize.h"

namespace lpv {

/// Every stage with its programs; one per device, on its GL thread.
class Pipeline {
 public:
  /// `pieceSeconds`: how long one piece of GPU work may take at most.
  explicit Pipeline(double pieceSeconds) : pieceSeconds_(pieceSeconds) {}

  /// Brings `session` to the request's scene and fills `result`. All three outlive the coroutine. Throws gpu::Failure.
  GpuTask tick(SessionState& session, const TickRequest& request, TickResult& result);

 private:
  GpuTask voxelize(SessionState& session, const TickRequest& request, TickReport& report);
  GpuTask gather(SessionState& session, const TickRequest& request);
  GpuTask makeVolumes(SessionState& session, const TickRequest& request, VolumeCopies& copies);
  GpuTask drawFrame(SessionState& session, const TickRequest& request, const FrameRequest& frame, View& view);
  Pacing pacing(const SessionState& session) const;

  double pieceSeconds_;
  SceneCache cache_;
  Voxelizer voxelizer_;
  Injector injector_;
  Propagator propagator_;
  Gatherer gatherer_;
  VolumeMaker volumeMaker_;
  MeshDrawer drawer_;
  GbufferRenderer gbufferRenderer_;
  EmitterRenderer emitterRenderer_;
  ShadingPass shadingPass_;
};

}  // namespace lpv
