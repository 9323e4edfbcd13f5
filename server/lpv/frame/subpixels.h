#pragma once
// Stage: edges and textures, from several samples of each pixel. Light is found once per pixel, in its middle; here is
// found how much of the pixel shows which surface, of what albedo, and how much a light in front. What is unlike the
// middle of its pixel may be lit where it is.

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

/// What a picture's subpixels are made from, where all are lit as pixels' middles.
struct SubpixelInputs {
  Stamp picture = 0;  ///< of the G-buffer
  std::vector<LightPtr> lights;
  int samples = 0;  ///< per pixel
  Stamp haze = 0;  ///< of what takes light on its way to the camera; 0: nothing does

  bool operator==(const SubpixelInputs&) const = default;
};

/// Of a picture (shaders/frame/subpixels.glsl).
struct SubpixelBuffer {
  SubpixelBuffer(const glm::ivec2& size, bool apart);
  glm::ivec2 size() const { return {radiance.size()}; }

  bool apart;  ///< samples that no middle tells the light of are lit where they are
  gpu::Texture radiance;  ///< RGBA32F: the mean of lights in front, as seen; apart: of surfaces alone, and as alpha how
                          ///< much of the pixel is lights by the same samples, until all is summed up
  gpu::Texture lights;  ///< apart: RGBA32F: the mean of lights in front, and how much of the pixel they are
  // Not apart: mean albedo of samples that are lit as this pixel, or as one of two beside it; RGBA16F.
  gpu::Texture own, first, second;
  Cached<SubpixelInputs> shown;
};

/// Samples of pixels that are lit where they are: a few places of each pixel, where light is found. Pictures of the
/// places lie side by side.
struct ApartBuffer {
  /// `size`: in pixels.
  explicit ApartBuffer(const glm::ivec2& size);
  glm::ivec2 size() const { return {albedo.size()}; }

  gpu::Texture albedo;  ///< RGBA16F: the mean of those at a place (shaders/frame/subpixels.glsl)
  gpu::Texture place;  ///< RGBA32F: of the first of them, grid space; a: its depth
  gpu::Texture normal;  ///< RG16, octahedral
  gpu::Texture light;  ///< RGBA32F: E there (NearFieldPass::lookFromApart)
};

/// Some rows of a picture, which are sampled at a time.
struct SampledRows {
  int first, end;  ///< of the picture: these are wanted
  int firstSampled, sampled;  ///< with those beside them, whose light is looked at: the first, and how many
};

/// All of a picture's. `apart`: samples are lit where they are.
std::vector<SampledRows> sampledRows(const glm::ivec2& size, bool apart);

/// What a sample of each pixel of some rows shows, and the places apart of all samples.
struct SampleBuffer {
  SampleBuffer(const glm::ivec2& size, bool seesPanes, bool apart);

  Gbuffer gbuffer;
  EmitterBuffer emitters;
  std::optional<PaneBuffer> panes;
  std::optional<ApartBuffer> apart;
  gpu::Framebuffer depth;  ///< of the G-buffer, alone; where samples are lit apart
  gpu::Buffer drawnParams;  ///< layout::FrameParams of the sample; other pictures may be drawn between its surfaces
};

/// A picture that is sampled, after its middles are drawn and, where some are lit apart, lit.
struct SubpixelSources {
  const Gbuffer& middles;
  const EmitterBuffer& seenLights;
  const FrameRows& request;
  const Scene& scene;
  const SceneResources& resources;
  const MeshDrawer& drawer;
  const gpu::Buffer& frameParams;
  const GpuOccluders* haze = nullptr;  ///< what is in the camera's way; null: nothing
  // Of what is lit apart:
  const gpu::Texture* light = nullptr;  ///< E in middles
  const gpu::Texture* shine = nullptr;  ///< with haze: what it scatters towards the camera
  const gpu::Texture* gloss = nullptr;  ///< of GlossBuffer; null: surfaces are matte
  int rays = 0;  ///< that a place sends to each pool of lights, at most
};

class SubpixelPass {
 public:
  SubpixelPass(GbufferRenderer& gbuffer, EmitterRenderer& emitters, PaneRenderer& panes)
      : gbuffer_(gbuffer),
        emitters_(emitters),
        panes_(panes),
        params_("subpixel params", sizeof(layout::SubpixelParams), gpu::BufferUse::kDynamic) {}

  /// Before the first rows of a picture.
  static void begin(const SubpixelBuffer& buffer);
  /// Lights in front have half as many samples more: their edges show most.
  GpuTask sample(SubpixelBuffer& buffer, SampleBuffer& samples, const SampledRows& rows, const SubpixelSources& sources,
                 Pacing pacing);
  /// Then, with light at their places, what of these rows is lit apart.
  GpuTask sumApart(SubpixelBuffer& buffer, const ApartBuffer& apart, const SampledRows& rows,
                   const SubpixelSources& sources);

 private:
  struct SumVariant {
    bool gloss = false;
    bool haze = false;
    bool operator==(const SumVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_GLOSS", gloss), gpu::define("LPV_HAZE", haze)}; }
  };
  struct Variant {
    bool panes = false;
    bool apart = false;
    SumVariant shown;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const {
      gpu::Defines out = shown.defines();
      out.push_back(gpu::define("LPV_PANES", panes));
      out.push_back(gpu::define("LPV_APART", apart));
      return out;
    }
  };
  GbufferRenderer& gbuffer_;
  EmitterRenderer& emitters_;
  PaneRenderer& panes_;
  void bind(const SubpixelBuffer& buffer, const SampleBuffer& samples, const SubpixelSources& sources) const;
  /// Where in some rows lights may be, and the surfaces that may be before them.
  struct LitPart {
    PixelRange pixels;
    std::vector<DrawItem> surfaces;
  };
  static LitPart litPart(const SampledRows& rows, const SubpixelSources& sources);
  /// One sample of each pixel; `lights`: of lights alone, where they may be. Else null.
  GpuTask draw(SampleBuffer& samples, const SampledRows& rows, const SubpixelSources& sources, const glm::vec2& offset,
               const LitPart* lights, Pacing pacing);

  gpu::Programs<Variant> add_{{"frame/subpixels.comp"}};
  gpu::Programs<SumVariant> sum_{{"frame/apart_sum.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
