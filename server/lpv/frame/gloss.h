#pragma once
// Stage: what the surfaces of a picture reflect like mirrors, sharply or not (MATHS.md 3e): rays in directions of each
// pixel's lobe and to points of the lights, and the light where they meet surfaces.

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/near_field.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/gloss_scene.h"

namespace lpv {

struct GlossBuffer {
  explicit GlossBuffer(const glm::ivec2& size);

  glm::ivec2 size;
  int rows;            ///< of a band, which is known at a time
  gpu::Texture gloss;  ///< RGBA32F: radiance of the lobes; a: of other light, what is reflected
  gpu::Texture lights, surfaces;  ///< RGBA32F: what they reflect of these, before it is smoothed (shaders/layout.h)
  gpu::Texture met;    ///< RGBA32F, of a band: E where rays met a surface, pictures beside each other
  gpu::Buffer points;  ///< of a band: layout::kGlossPoints
  gpu::Buffer list;    ///< layout::kNearFieldPoints
  ShadowPoints shadows; ///< of the list
};

/// What reflections show, and how long they look.
struct GlossSources {
  const GlossScene& scene;
  const LightPools& points;  ///< those of `scene`
  const EmitterBufferList& emitters;
  const ShadowCasters& shadows;  ///< for the places that are met
  int turns = 1;         ///< of layout::kGlossRays rays in directions of the lobe, and as many to lights
  bool shadowed = true;  ///< something may stand in the lights' way
  int spacing = 1;       ///< pixels between those at whose places light is found: 1, or up to layout::kGlossReach
  int firstRow = 0;      ///< of the pixels, in the picture that they are some rows of
};

class GlossPass {
 public:
  explicit GlossPass(NearFieldPass& nearField);
  /// `frameParams` holds the view's FrameParams; `gbuffer` has materials.
  GpuTask run(GlossBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights, const GlossSources& sources,
              const gpu::Buffer& frameParams, Pacing pacing);

 private:
  struct Inputs;
  /// A band of so many rows, of which `rowsWanted` are: all turns of rays, then the light at the places that were met.
  GpuTask runBand(const Inputs& inputs, layout::GlossParams band, Pacing pacing);
  void bind(const Inputs& inputs, const layout::GlossParams& params);

  struct RayVariant {
    bool transparent = false;
    bool operator==(const RayVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_TRANSPARENT", transparent)}; }
  };
  NearFieldPass& nearField_;
  gpu::Programs<RayVariant> rays_{{"frame/gloss_rays.comp"}};
  gpu::ProgramVariants sum_{{"frame/gloss_sum.comp"}};
  gpu::ProgramVariants filter_{{"frame/gloss_filter.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
