#pragma once
// Stage: edges and textures, from several samples of each pixel. Light is found once per pixel, in its middle; here is
// found how much of the pixel shows which surface, of what albedo, and how much a light in front. What is thinner than
// a pixel, and the middle of none, may have a light of its own.

#include <memory>
#include <optional>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/program.h"
#include "gpu/texture.h"
#include "lpv/cached.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/frame_view.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/panes.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/occluders.h"

namespace lpv {

/// What a picture's subpixels are made from.
struct SubpixelInputs {
  Stamp picture = 0;  ///< of the G-buffer
  std::vector<LightPtr> lights;
  int samples = 0;  ///< per pixel
  Stamp haze = 0;  ///< of what takes light on its way to the camera; 0: nothing does
  std::optional<Grid> grid;  ///< that places of samples apart are in; none: there are none

  bool operator==(const SubpixelInputs&) const = default;
};

/// Samples of a picture's pixels that are lit as no pixel's middle: one place of each pixel, where light is found.
struct ApartBuffer {
  explicit ApartBuffer(const glm::ivec2& size);

  gpu::Texture albedo;  ///< RGBA16F: their mean
  gpu::Texture place;   ///< RGBA32F: where rays begin, grid space
  gpu::Texture normal;  ///< RG16, octahedral
  gpu::Texture light;   ///< RGBA32F: E there (NearFieldPass::lookFromApart)
};

/// Of a picture (shaders/frame/subpixels.glsl).
struct SubpixelBuffer {
  SubpixelBuffer(const glm::ivec2& size, bool apart);
  glm::ivec2 size() const { return {own.size()}; }

  gpu::Texture emission;            ///< RGBA32F: mean radiance of lights in front, as seen
  gpu::Texture own, first, second;  ///< RGBA16F: mean albedo of samples that are lit as this pixel, or as one beside it
  std::optional<ApartBuffer> apart;  ///< none: all are lit as the pixel around them that is most like them
  Cached<SubpixelInputs> shown;
};

class SubpixelPass {
 public:
  SubpixelPass(GbufferRenderer& gbuffer, EmitterRenderer& emitters, PaneRenderer& panes)
      : gbuffer_(gbuffer), emitters_(emitters), panes_(panes) {}

  /// After the G-buffer and the lights of the same picture, whose middles they are. Large pictures are sampled some
  /// rows at a time. `haze`: what is in the camera's way, null where nothing is.
  GpuTask run(SubpixelBuffer& buffer, const Gbuffer& middles, const EmitterBuffer& seenLights, const FrameRows& request,
              const Scene& scene, const SceneResources& resources, const MeshDrawer& drawer,
              const gpu::Buffer& frameParams, const GpuOccluders* haze, Pacing pacing);

 private:
  struct Rows;
  struct Variant {
    bool panes = false;
    bool haze = false;
    bool apart = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const {
      return {gpu::define("LPV_PANES", panes), gpu::define("LPV_HAZE", haze), gpu::define("LPV_APART", apart)};
    }
  };
  GbufferRenderer& gbuffer_;
  EmitterRenderer& emitters_;
  PaneRenderer& panes_;
  gpu::Programs<Variant> add_{{"frame/subpixels.comp"}};
};

}  // namespace lpv
