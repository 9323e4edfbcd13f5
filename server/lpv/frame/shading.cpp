#include "lpv/frame/shading.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>

#include "gpu/gl.h"
#include "scene/tonemap.h"

namespace lpv {

namespace {

int exposureGroups(const glm::ivec2& size) {
  return (size.x * size.y + layout::kExposurePixels - 1) / layout::kExposurePixels;
}

gpu::Texture colourTarget(const char* label, const glm::ivec2& size, GLenum format) {
  return gpu::Texture::make2d(label, size, format, gpu::Sampling::kNearestClamp);
}

/// `lit` is null for the pass from radiance to the display.
void bindInputs(const FrameTargets& targets, const Gbuffer& gbuffer, const IrradianceSources* lit) {
  targets.frameParams.bindUniform(layout::kParams);
  gbuffer.albedo.bind(layout::kAlbedo);
  gbuffer.normal.bind(layout::kNormal);
  gbuffer.depth.bind(layout::kSurfaceDepth);
  targets.emitters.emission.bind(layout::kEmission);
  targets.emitters.depth.bind(layout::kEmitterDepth);
  if (lit == nullptr) {
    targets.radiance.bind(layout::kRadiance);
    targets.exposure.bindStorage(layout::kExposure);
    return;
  }
  if (lit->transport != Transport::kPropagate) lit->emitters->view.bind(layout::kDirect);
  if (lit->nearField != nullptr) lit->nearField->bind(layout::kNearField);
  if (lit->panes != nullptr) lit->panes->bind(layout::kPanes);
  if (lit->gloss != nullptr) lit->gloss->bind(layout::kGloss);
  if (lit->haze != nullptr) {
    lit->haze->scattered.bind(layout::kHaze);
    lit->hazeBox->bind();
  }
  if (lit->subpixels != nullptr) {
    lit->subpixels->radiance.bind(layout::kEmission);
    if (!lit->subpixels->apart) {
      lit->subpixels->own.bind(layout::kSubpixelsOwn);
      lit->subpixels->first.bind(layout::kSubpixelsFirst);
      lit->subpixels->second.bind(layout::kSubpixelsSecond);
    }
  }
  if (lit->volume == nullptr) return;
  const int count = lit->volume->channels == 1 ? 1 : 3;
  for (int i = 0; i < count; ++i) lit->volume->colours[std::size_t(i)].bind(std::uint32_t(layout::kIncident + i));
  if (lit->volume->emitterDistance) lit->volume->emitterDistance.bind(layout::kEmitterDistance);
}

static_assert(int(Lookup::kSh2) == LPV_LOOKUP_SH2 && int(Lookup::kCap) == LPV_LOOKUP_CAP &&
              int(Lookup::kNearest) == LPV_LOOKUP_NEAREST);

/// Where receivers evaluate the lights themselves.
enum class NearFieldMode {
  kNowhere = LPV_NEAR_FIELD_NOWHERE,
  kEmitters = LPV_NEAR_FIELD_EMITTERS,
  kEverywhere = LPV_NEAR_FIELD_EVERYWHERE,
  kSampled = LPV_NEAR_FIELD_SAMPLED,
  kKnown = LPV_NEAR_FIELD_KNOWN
};

NearFieldMode nearFieldMode(const IrradianceSources& lit) {
  if (lit.volume == nullptr) return lit.nearField != nullptr ? NearFieldMode::kKnown : NearFieldMode::kEverywhere;
  if (lit.transport != Transport::kGather) return NearFieldMode::kNowhere;
  return lit.nearField != nullptr ? NearFieldMode::kSampled : NearFieldMode::kEmitters;
}

void prepareFullScreen() {
  glClipControl(GL_UPPER_LEFT, GL_ZERO_TO_ONE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glEnable(GL_SCISSOR_TEST);
}

}  // namespace

FrameTargets::FrameTargets(const glm::ivec2& s, PixelFormat format, bool automaticExposure)
    : size(s), emitters(s), frameParams("frame params", sizeof(layout::FrameParams), gpu::BufferUse::kDynamic) {
  const bool toDisplay = format == PixelFormat::kRgb8;
  if (!toDisplay || automaticExposure) {
    radiance = colourTarget("radiance", size, GL_RGBA32F);
    radianceTarget = gpu::Framebuffer("radiance", {&radiance}, nullptr);
  }
  if (toDisplay) {
    display = colourTarget("display", size, GL_RGBA8);
    displayTarget = gpu::Framebuffer("display", {&display}, nullptr);
  }
  if (toDisplay && automaticExposure)
    exposure = gpu::Buffer("exposure", (1 + std::size_t(exposureGroups(size))) * sizeof(glm::vec4));
}

bool FrameTargets::fits(const FrameRequest& request) const {
  const bool toDisplay = request.format == PixelFormat::kRgb8;
  return size == request.size && bool(display) == toDisplay &&
         bool(exposure) == (toDisplay && request.exposure.automatic);
}

layout::ExposureParams exposureParams(const Exposure& exposure) {
  return {.factor = float(std::exp2(exposure.ev)), .key = float(kAutoExposureKey), .firstGroup = 0, .pad0 = 0};
}

gpu::Defines ShadingPass::Variant::defines() const {
  return {gpu::define("LPV_CHANNELS", channels),  gpu::define("LPV_GROUPS", groups),
          gpu::define("LPV_LOOKUP", int(lookup)), gpu::define("LPV_NEAR_FIELD", nearField),
          gpu::define("LPV_LOOKED_AT", lookedAt), gpu::define("LPV_DISPLAY", display),
          gpu::define("LPV_PANES", panes),        gpu::define("LPV_SUBPIXELS", subpixels),
          gpu::define("LPV_APART", apart),        gpu::define("LPV_IRRADIANCE", irradiance),
          gpu::define("LPV_GLOSS", gloss),        gpu::define("LPV_HAZE", haze)};
}

ShadingPass::ShadingPass() { glCreateVertexArrays(1, &noVertices_); }

ShadingPass::~ShadingPass() { glDeleteVertexArrays(1, &noVertices_); }

/// A full-screen pass, band by band.
GpuTask ShadingPass::fill(const gpu::Framebuffer& target, gpu::Program& program, const FrameTargets& targets,
                          const Gbuffer& gbuffer, const IrradianceSources* lit, Pacing pacing) {
  const glm::ivec2 size = target.size();
  for (int row = 0; row < size.y;) {
    const int rows = std::clamp(pacing.unitsFor(Stage::kShade) / size.x, 1, size.y - row);
    target.bind();
    prepareFullScreen();
    bindInputs(targets, gbuffer, lit);
    glScissor(0, row, size.x, rows);
    glBindVertexArray(noVertices_);
    program.use();
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDisable(GL_SCISSOR_TEST);  // it would cut clears too
    row += rows;
    co_yield submitted(Stage::kShade, double(rows) * size.x);
  }
}

void ShadingPass::bindExposure(const FrameTargets& targets) {
  gpu::memoryBarrier();
  targets.frameParams.bindUniform(layout::kParams);
  targets.radiance.bind(layout::kRadiance);
  targets.exposure.bindStorage(layout::kExposure);
}

GpuTask ShadingPass::findExposure(FrameTargets& targets, layout::ExposureParams params, Pacing pacing) {
  const int groups = exposureGroups(targets.size);
  for (int first = 0; first < groups;) {
    const int count = std::clamp(pacing.unitsFor(Stage::kShade) / layout::kExposurePixels, 1, groups - first);
    params.firstGroup = std::uint32_t(first);
    targets.frameParams.update(offsetof(layout::FrameParams, exposure), gpu::bytesOfValue(params));
    bindExposure(targets);
    exposure_.get({.finish = false}).dispatch(std::uint32_t(count));
    first += count;
    co_yield submitted(Stage::kShade, double(count) * layout::kExposurePixels);
  }
  bindExposure(targets);
  exposure_.get({.finish = true}).dispatch(1);
  gpu::memoryBarrier();
}

/// How surfaces receive light.
ShadingPass::Variant ShadingPass::receiving(const IrradianceSources& lit) {
  const bool grid = lit.volume != nullptr;
  const NearFieldMode mode = nearFieldMode(lit);
  const bool nearLights = mode == NearFieldMode::kEmitters || mode == NearFieldMode::kSampled;
  Variant out;
  out.channels = grid && lit.volume->channels > 1 ? 3 : 1;
  out.groups = grid ? lit.volume->groups : 1;
  out.lookup = lit.lookup;
  out.nearField = int(mode);
  out.lookedAt = nearLights && lit.emitters->lookedAt > 0;
  return out;
}

GpuTask ShadingPass::findIrradiance(const gpu::Texture& out, const FrameTargets& targets, const Gbuffer& gbuffer,
                                    const IrradianceSources& lit, Pacing pacing) {
  const gpu::Framebuffer target("irradiance", {&out}, nullptr);
  Variant variant = receiving(lit);
  variant.irradiance = true;
  co_await fill(target, shade_.get(variant), targets, gbuffer, &lit, pacing);
}

GpuTask ShadingPass::run(FrameTargets& targets, const Gbuffer& gbuffer, const IrradianceSources& lit,
                         const FrameRequest& request, Pacing pacing) {
  const bool toDisplay = request.format == PixelFormat::kRgb8, automatic = toDisplay && request.exposure.automatic;
  const bool direct = toDisplay && !automatic;  // exposure known: one pass
  Variant shown = receiving(lit);
  shown.display = direct;
  shown.panes = lit.panes != nullptr;
  shown.gloss = lit.gloss != nullptr;
  shown.haze = lit.haze != nullptr;
  shown.subpixels = lit.subpixels != nullptr;
  shown.apart = lit.subpixels != nullptr && lit.subpixels->apart;
  shown.irradiance = request.quantity == FrameQuantity::kIrradiance;
  gpu::Program& program = shade_.get(shown);
  co_await fill(direct ? targets.displayTarget : targets.radianceTarget, program, targets, gbuffer, &lit, pacing);
  if (!automatic) co_return;
  co_await findExposure(targets, exposureParams(request.exposure), pacing);
  co_await fill(targets.displayTarget, display_.get({}), targets, gbuffer, nullptr, pacing);
}

}  // namespace lpv
