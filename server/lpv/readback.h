#pragma once
// Stage: results from the GPU to the CPU, without waiting: queue the copy, fence, poll, then read the mapping.

#include "gpu/fence.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/session_state.h"

namespace lpv {

/// Copies of a tick that are under way: queued by the functions below, taken by finish().
struct VolumeCopies {
  bool transported = false;
  bool injected = false;
  bool counters = false;
};

/// Makes the product (or the injected field) readable by the CPU once a later fence has signalled.
GpuTask copyVolume(SessionState& session, VolumeStage stage);
/// What the lights look like to receivers near them, along with the transported volume.
void queueEmitterListCopy(SessionState& session);
/// The counters of the voxelization and volume stages.
void queueCounterCopy(SessionState& session);
/// After the fence: what was copied, volumes and counts, into the session's state.
GpuTask takeCopies(SessionState& session, const VolumeCopies& copies);

/// The finished picture of a view; call it once drawing is known to have ended (gpu::Readback::copyPixels).
GpuTask copyFrame(View& view, Pacing pacing);
/// After the fence: the picture, into `out`.
GpuTask takeFrame(const View& view, const FrameRequest& request, FramePtr& out);

/// `readback` with room for at least `bytes`; grows, never shrinks.
gpu::Readback& withRoom(gpu::Readback& readback, const char* label, std::size_t bytes);

}  // namespace lpv
