#pragma once
// Stage: the scene's surfaces as one camera sees them.

#include <vector>

#include "engine/engine.h"
#include "gpu/framebuffer.h"
#include "gpu/texture.h"
#include "lpv/frame/draw.h"
#include "lpv/pacing/stage_clock.h"

namespace lpv {

/// Albedo, normal and depth of the nearest surface in each pixel; true as long as nothing in its key changes.
struct Gbuffer {
  explicit Gbuffer(const glm::ivec2& size);

  gpu::Texture albedo;  ///< RGBA16F, linear; alpha 1 where there is a surface
  gpu::Texture normal;  ///< RG16, octahedral, world space, towards the viewer
  gpu::Texture depth;   ///< 32F, reversed: 0 where there is nothing
  gpu::Framebuffer target;

  /// What it shows.
  Camera camera;
  std::vector<SurfacePtr> surfaces;
  bool complete = false;

  bool shows(const FrameRequest& request, const Scene& scene) const;
};

class GbufferRenderer {
 public:
  /// Draws the scene's surfaces, some triangles at a time. `frameParams` holds the view's FrameParams.
  GpuTask run(Gbuffer& gbuffer, const FrameRequest& request, const Scene& scene, const SceneResources& resources,
              const MeshDrawer& drawer, const gpu::Buffer& frameParams, Pacing pacing);

 private:
  gpu::ProgramVariants programs_{{"frame/gbuffer.vert", "frame/gbuffer.frag"}};
};

}  // namespace lpv
