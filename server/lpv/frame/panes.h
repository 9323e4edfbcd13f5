#pragma once
// Stage: what cameras see through, panes and the holes of masks (scene/transparency.h): how much of its radiance what
// lies behind keeps.

#include "gpu/framebuffer.h"
#include "gpu/texture.h"
#include "lpv/frame/draw.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/frame_view.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/pacing/gpu_task.h"

namespace lpv {

struct PaneBuffer {
  explicit PaneBuffer(const glm::ivec2& size);

  gpu::Texture share;  ///< RGBA16F, per colour; 1 where no pane is in front
  gpu::Framebuffer target;
};

class PaneRenderer {
 public:
  /// Whether a scene has panes in the picture of a camera, about.
  static bool needed(const FrameRows& request, const Scene& scene);
  /// After the G-buffer and the lights of the same picture.
  GpuTask run(const PaneBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& emitters, const FrameRows& request,
              const Scene& scene, const SceneResources& resources, const MeshDrawer& drawer,
              const gpu::Buffer& frameParams, Pacing pacing);

 private:
  gpu::ProgramVariants programs_{{"frame/gbuffer.vert", "frame/panes.frag"}};
};

}  // namespace lpv
