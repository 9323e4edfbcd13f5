#pragma once
// Stage: from G-buffer, emitters and volume to the picture, exposed and tone-mapped where it is for display.

#include <optional>

#include "engine/engine.h"
#include "gpu/framebuffer.h"
#include "gpu/program.h"
#include "lpv/frame/emitters.h"
#include "lpv/frame/gbuffer.h"
#include "lpv/frame/haze.h"
#include "lpv/frame/subpixels.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/incident_textures.h"
#include "lpv/transport/emitter_list.h"

namespace lpv {

/// What one frame is made in; only what its format and exposure need.
struct FrameTargets {
  FrameTargets(const glm::ivec2& size, PixelFormat format, bool automaticExposure);

  glm::ivec2 size;
  EmitterBuffer emitters;
  gpu::Buffer frameParams;      ///< layout::FrameParams
  gpu::Texture radiance;        ///< RGBA32F, linear; for 32-bit frames and automatic exposure
  gpu::Framebuffer radianceTarget;
  gpu::Texture display;         ///< RGBA8, sRGB-coded; for 8-bit frames
  gpu::Framebuffer displayTarget;
  gpu::Buffer exposure;         ///< vec4 (factor, stops, -, -), then sums; for automatic exposure

  /// Where the finished picture is.
  const gpu::Framebuffer& result() const { return display ? displayTarget : radianceTarget; }
  bool fits(const FrameRequest& request) const;
};

/// FrameParams::exposure, for the first of a picture's dispatches.
layout::ExposureParams exposureParams(const Exposure& exposure);

/// Where a surface's irradiance comes from.
struct IrradianceSources {
  Transport transport = Transport::kPropagate;
  Lookup lookup = Lookup::kSh2;
  const IncidentTextures* volume = nullptr;  ///< null where pixels look at the lights everywhere
  const EmitterBufferList* emitters = nullptr;  ///< not read with PROPAGATE
  const gpu::Texture* nearField = nullptr;  ///< of NearFieldBuffer; null: pixels look at the lights themselves
  const gpu::Texture* panes = nullptr;  ///< of PaneBuffer; null: no pane is in the picture, or in the subpixels already
  const gpu::Texture* gloss = nullptr;  ///< of GlossBuffer; null: surfaces are matte
  const HazeBuffer* haze = nullptr;  ///< null: there is none
  const GpuOccluders* hazeBox = nullptr;  ///< with haze, where it is
  const SubpixelBuffer* subpixels = nullptr;  ///< null: the middle says what is in a pixel
};

class ShadingPass {
 public:
  ShadingPass();
  ShadingPass(const ShadingPass&) = delete;
  ShadingPass& operator=(const ShadingPass&) = delete;
  ~ShadingPass();

  GpuTask run(FrameTargets& targets, const Gbuffer& gbuffer, const IrradianceSources& lit, const FrameRequest& request,
              Pacing pacing);
  /// E in pixels' middles, into a picture as NearFieldBuffer::irradiance; of `lit`, what surfaces receive is read.
  GpuTask findIrradiance(const gpu::Texture& out, const FrameTargets& targets, const Gbuffer& gbuffer,
                         const IrradianceSources& lit, Pacing pacing);

 private:
  GpuTask fill(const gpu::Framebuffer& target, gpu::Program& program, const FrameTargets& targets,
               const Gbuffer& gbuffer, const IrradianceSources* lit, Pacing pacing);
  static void bindExposure(const FrameTargets& targets);
  GpuTask findExposure(FrameTargets& targets, layout::ExposureParams params, Pacing pacing);

  struct Variant {
    int channels = 1;  ///< of the textures: 1 or 3
    int groups = 1;
    Lookup lookup = Lookup::kSh2;
    int nearField = 0;  ///< LPV_NEAR_FIELD_..
    bool lookedAt = false;  ///< shares of lights, wherever a pixel is
    bool display = false;
    bool panes = false;
    bool gloss = false;
    bool haze = false;
    bool subpixels = false;
    bool apart = false;
    bool irradiance = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  static Variant receiving(const IrradianceSources& lit);
  struct ExposureVariant {
    bool finish = false;
    bool operator==(const ExposureVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_FINISH", finish)}; }
  };
  gpu::Programs<Variant> shade_{{"frame/fullscreen.vert", "frame/shading.frag"}};
  gpu::ProgramVariants display_{{"frame/fullscreen.vert", "frame/display.frag"}};
  gpu::Programs<ExposureVariant> exposure_{{"frame/exposure.comp"}};
  std::uint32_t noVertices_ = 0;  ///< a vertex array without attributes
};

}  // namespace lpv
