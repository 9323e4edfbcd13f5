#pragma once
// Stage: results from the GPU to the CPU, without waiting: queue the copy, fence, poll, then read the mapping.

#include <string>
#include <vector>

#include "gpu/fence.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/session_state.h"
#include "lpv/transport/emitter_list.h"
#include "shaders/layout.h"

namespace lpv {

/// Where copies of a tick's volumes and counts go; they grow, and are used again.
struct Readbacks {
  gpu::Readback transported, injected, emitterList, emitterDistance, patchLights, patches, pieceLights, counters;
};

/// Makes field.incidentVolume readable by the CPU, in `target`, once a later fence has signalled.
GpuTask copyVolume(const LightField& field, gpu::Readback& target);
/// The same for what the lights look like to receivers near them, which goes along with the transported volume.
void copyEmitterList(const LightField& field, const EmitterBufferList& emitters, Readbacks& readbacks);
/// The same for the counters of the inject and volume stages.
void copyCounters(const LightField& field, Readbacks& readbacks);

/// After the fence: the volume's product, layer by layer, and with `guarded` the same with guard cells. What is given
/// outlives the coroutine.
GpuTask takeVolume(const gpu::Readback& readback, const LightField& field, const std::vector<std::string>& groups,
                   bool guarded, Volume& out);
/// After the fence: the list; null with PROPAGATE. `visibility`: null where nothing stands in the lights' way;
/// `reflected`: null without bounces.
EmitterListPtr takeEmitterList(const LightField& field, const EmitterBufferList& emitters, const Readbacks& readbacks,
                               LightVisibilityPtr visibility, ReflectedLightPtr reflected);
/// What patches send, and after the fence: of these patches.
void copyReflected(const PatchSet& patches, Readbacks& readbacks);
ReflectedLightPtr takeReflected(const PatchSet& patches, const Readbacks& readbacks);
layout::Counters takeCounters(const Readbacks& readbacks);

/// The finished picture of a view; call it once drawing is known to have ended (gpu::Readback::copyPixels).
GpuTask copyFrame(View& view, Pacing pacing);
/// A picture that has room for all its pixels, and none of them.
std::shared_ptr<Frame> emptyFrame(const FrameRequest& request);
/// After the fence: some of the view's rows, appended to the picture.
GpuTask takeRows(const View& view, int first, int rows, Frame& out);
/// After the fence: the picture, into `out`.
GpuTask takeFrame(const View& view, const FrameRequest& request, FramePtr& out);

/// `readback` with room for at least `bytes`; grows, never shrinks.
gpu::Readback& withRoom(gpu::Readback& readback, const char* label, std::size_t bytes);

}  // namespace lpv
