#pragma once
// Stage: what haze scatters once towards the camera (MATHS.md 3g): rays from places along each pixel's view to points
// of the lights, and of what surfaces reflect.

#include <vector>

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/gloss_scene.h"
#include "lpv/resources/light_pools.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/occluders.h"
#include "lpv/resources/patch_set.h"
#include "lpv/transport/emitter_list.h"

namespace lpv {

struct HazeBuffer {
  explicit HazeBuffer(const glm::ivec2& size);

  glm::ivec2 size;
  gpu::Texture sum;        ///< RGBA32F: what all rays have found, and its variance
  gpu::Texture scattered;  ///< RGBA32F: radiance towards the camera
};

/// What shines into the haze, and how long pixels look.
struct HazeSources {
  const std::vector<EmittingLight>& lights;  ///< those of `pools`; there are some
  const LightPools& pools;
  const GlossScene& shown;  ///< what rays meet of them
  const EmitterBufferList& emitters;  ///< the same lights
  const GpuOccluders& occluders;  ///< of a scene with haze
  const PatchSet* reflected = nullptr;  ///< null: nothing
  glm::ivec3 dims{0};       ///< cells
  double scattering = 0.0;  ///< per cell
  double anisotropy = 0.0;
  int turns = 1;            ///< of layout::kHazeRays rays to lights, and as many to surfaces
  int firstRow = 0;         ///< of the pixels, in the picture that they are some rows of
  bool panes = false;       ///< in the picture
};

class HazePass {
 public:
  HazePass();
  /// `frameParams` holds the view's FrameParams.
  GpuTask run(HazeBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights, const HazeSources& sources,
              const gpu::Buffer& frameParams, Pacing pacing);

 private:
  struct Picture;
  GpuTask look(const Picture& picture, const gpu::BufferTexture& points, std::vector<layout::HazeLight> lights,
               bool ofSurfaces, Pacing pacing);

  struct Variant {
    bool panes = false;
    bool meshes = false;  ///< lights of more than few polygons, or with pictures
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const {
      return {gpu::define("LPV_TRANSPARENT", true), gpu::define("LPV_PANES", panes), gpu::define("LPV_MESHES", meshes)};
    }
  };
  gpu::Programs<Variant> rays_{{"frame/haze.comp"}};
  gpu::ProgramVariants filter_{{"frame/haze_filter.comp"}};
  gpu::Buffer params_, lights_;
};

}  // namespace lpv
