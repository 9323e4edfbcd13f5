#pragma once
// Stage: the lights themselves as one camera sees them, apart from the surfaces, so that a moving light does not redraw
// the room.

#include <optional>

#include "gpu/framebuffer.h"
#include "gpu/texture.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/frame_view.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"

namespace lpv {

/// Radiance and depth of the nearest light in each pixel; which of light and surface is in front is decided in shading.
struct EmitterBuffer {
  explicit EmitterBuffer(const glm::ivec2& size);

  gpu::Texture emission;  ///< RGBA32F, radiance, W/(sr m^2)
  gpu::Texture depth;  ///< 32F, reversed: 0 where there is nothing
  gpu::Framebuffer target;
};

/// Where lights may be in the picture that cameras see.
PicturePart partOfLights(const FrameRows& request, const Scene& scene);

class EmitterRenderer {
 public:
  /// `pixels`: other ones stay as they are.
  GpuTask run(const EmitterBuffer& buffer, const FrameRows& request, const Scene& scene,
              const SceneResources& resources, const MeshDrawer& drawer, const gpu::Buffer& frameParams, Pacing pacing,
              std::optional<PixelRange> pixels = {});

 private:
  gpu::ProgramVariants programs_{{"frame/emitters.vert", "frame/emitters.frag"}};
};

}  // namespace lpv
