#pragma once
// Stage: pixels of a G-buffer whose rays would begin behind what the camera sees get a depth that is nearer.

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/occluders.h"

namespace lpv {

class BuriedPass {
 public:
  BuriedPass();
  ~BuriedPass();
  BuriedPass(const BuriedPass&) = delete;
  BuriedPass& operator=(const BuriedPass&) = delete;

  /// After the G-buffer is drawn, some rows at a time. `frameParams` holds the view's FrameParams.
  GpuTask run(const Gbuffer& gbuffer, const GpuOccluders& occluders, const gpu::Buffer& frameParams, Pacing pacing);

 private:
  struct Variant {
    bool transparent = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_TRANSPARENT", transparent)}; }
  };
  gpu::Programs<Variant> find_{{"frame/buried.comp"}};
  gpu::ProgramVariants draw_{{"frame/buried.vert", "frame/buried.frag"}};
  gpu::Buffer params_;
  std::uint32_t noVertices_ = 0;
};

}  // namespace lpv
