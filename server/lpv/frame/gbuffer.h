#pragma once
// Stage: the scene's surfaces as one camera sees them.

#include <vector>

#include "gpu/framebuffer.h"
#include "gpu/texture.h"
#include "lpv/cached.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/frame_view.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"

namespace lpv {

/// What a G-buffer shows.
struct GbufferInputs {
  Camera camera;
  int firstRow = 0;
  std::vector<SurfacePtr> surfaces;
  Stamp blockers = 0;  ///< by which buried pixels were found (BuriedPass); 0: nobody has looked for them

  bool operator==(const GbufferInputs&) const = default;
};
GbufferInputs gbufferInputs(const FrameRows& request, const Scene& scene);

/// A surface to be drawn, alpha and all; nothing of it may be in the picture.
DrawItem drawItemOf(const FrameView& view, const Surface& surface, const SceneResources& resources);

/// Albedo, normal and depth of the nearest surface in each pixel, and what its lobe follows from where it is asked for.
struct Gbuffer {
  explicit Gbuffer(const glm::ivec2& size, bool glossy = false);

  gpu::Texture albedo;  ///< RGBA16F, linear, times the surface's alpha; alpha 1 where there is a surface
  gpu::Texture normal;  ///< RG16, octahedral, world space, towards the viewer
  gpu::Texture depth;  ///< 32F, reversed: 0 where there is nothing
  gpu::Texture material;  ///< RG16: roughness and metalness; empty where nobody asks
  gpu::Framebuffer target;
  Cached<GbufferInputs> shown;
};

/// What of the scene's surfaces may be in a part of the picture.
std::vector<DrawItem> surfacesIn(const PicturePart& part, const FrameRows& request, const Scene& scene,
                                 const SceneResources& resources);

class GbufferRenderer {
 public:
  /// Draws the scene's surfaces, some triangles at a time. `frameParams` holds the view's FrameParams.
  GpuTask run(Gbuffer& gbuffer, const FrameRows& request, const Scene& scene, const SceneResources& resources,
              const MeshDrawer& drawer, const gpu::Buffer& frameParams, Pacing pacing);
  /// The depth of these alone, into some pixels of a target without colours.
  GpuTask runDepth(const gpu::Framebuffer& target, const PixelRange& pixels, const std::vector<DrawItem>& surfaces,
                   const MeshDrawer& drawer, const gpu::Buffer& frameParams, Pacing pacing);

 private:
  struct Variant {
    bool normals = false;
    bool texture = false;
    bool normalMap = false;
    bool alpha = false;
    bool gloss = false;
    bool glossMap = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  static Variant variantOf(const DrawItem& item, bool glossy);
  gpu::Programs<Variant> programs_{{"frame/gbuffer.vert", "frame/gbuffer.frag"}};
};

}  // namespace lpv
