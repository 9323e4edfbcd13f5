#pragma once
// Stage: the near field of a picture, evaluated at some of its pixels and interpolated between (GATHER; MATHS.md 3c).

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/incident_textures.h"
#include "lpv/transport/emitter_list.h"

namespace lpv {

/// Irradiance from the lights themselves in every pixel near them.
struct NearFieldBuffer {
  explicit NearFieldBuffer(const glm::ivec2& size);

  glm::ivec2 size;
  gpu::Texture irradiance;  ///< RGBA32F: E in W/m^2, and its weight beside the volume's: 0 far from lights
  gpu::Buffer tiles;        ///< uint per tile: 1 where it has near pixels
  gpu::Buffer points;       ///< ListHeader, then those to be evaluated, in fours
};

/// Where lights are, as receivers look at them.
struct NearLights {
  const EmitterBufferList* emitters = nullptr;
  const gpu::Texture* emitterDistance = nullptr;
};

/// In shaded pixels, about what they take on llvmpipe.
struct NearFieldWork {
  double weighed = 0.0;    ///< pixels
  double evaluated = 0.0;  ///< points that see the lights if they are near
  double between = 0.0;    ///< points of which some do
  double units() const { return weighed + 20.0 * evaluated + 4.0 * between; }
};

class NearFieldPass {
 public:
  NearFieldPass();
  /// `frameParams` holds the view's FrameParams.
  GpuTask run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
              const NearLights& lights, const gpu::Buffer& frameParams, Pacing pacing);

 private:
  struct Inputs;
  struct Pass;
  GpuTask run(const Inputs& inputs, const Pass& pass, Pacing pacing);

  struct Variant {
    int pass = 0;  ///< LPV_PASS_..
    gpu::Defines defines() const { return {gpu::define("LPV_PASS", pass)}; }
  };
  gpu::Programs<Variant> choose_{{"frame/near_field.comp"}};
  gpu::ProgramVariants evaluate_{{"frame/near_field_evaluate.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
