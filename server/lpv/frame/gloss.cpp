#include "lpv/frame/gloss.h"

#include <algorithm>

#include "gpu/gl.h"
#include "lpv/frame/parts.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr int kMostBlocks = 2048;  // at a time: the memory of what is known of places that are met
constexpr std::size_t kMostGlossPlaces = std::size_t(kMostBlocks) * kPointsOfBlock * layout::kGlossPlaces;
constexpr int kGlossBandPixels = 1 << 18, kLeastRows = 32;  // of a band
constexpr std::size_t kGlossPointBytes = 4 * sizeof(glm::vec4);

gpu::Texture glossPicture(const char* label, const glm::ivec2& size) {
  return gpu::Texture::make2d(label, size, GL_RGBA32F, gpu::Sampling::kNearestClamp);
}

gpu::Buffer deviceBuffer(const char* label, std::size_t bytes) {
  return {label, bytes, gpu::BufferUse::kDevice, gpu::Undefined{}};
}

/// What a turn of a block takes.
constexpr double kTurnUnits = NearFieldWork{.rays = 2.0 * layout::kGlossRays * kPointsOfBlock}.units();

void bindPicture(const Gbuffer& gbuffer, const GlossSources& sources, const gpu::Buffer& frameParams) {
  frameParams.bindUniform(layout::kParams);
  gbuffer.albedo.bind(layout::kAlbedo);
  gbuffer.normal.bind(layout::kNormal);
  gbuffer.depth.bind(layout::kSurfaceDepth);
  gbuffer.material.bind(layout::kGlossMaterial);
  sources.scene.bind();
}

}  // namespace

GlossBuffer::GlossBuffer(const glm::ivec2& s)
    : size(s),
      rows(std::min(s.y + 2 * layout::kGlossReach, std::max(kGlossBandPixels / s.x, kLeastRows))),
      gloss(glossPicture("gloss", s)),
      lights(glossPicture("gloss of lights", s)),
      surfaces(glossPicture("gloss of surfaces", s)),
      met(glossPicture("light where reflections met", {layout::kGlossPlaces * s.x, rows})),
      points(
          deviceBuffer("reflections", layout::kGlossPlaces * std::size_t(s.x) * std::size_t(rows) * kGlossPointBytes)),
      list("places that reflections met", sizeof(layout::ListHeader) + kMostGlossPlaces / 4 * sizeof(glm::uvec4),
           gpu::BufferUse::kDynamic, gpu::Undefined{}),
      shadows("shadow points of reflections", kMostGlossPlaces) {}

struct GlossPass::Inputs {
  GlossBuffer& buffer;
  const Gbuffer& gbuffer;
  const EmitterBuffer& seenLights;
  const GlossSources& sources;
  const gpu::Buffer& frameParams;
};

GlossPass::GlossPass(NearFieldPass& nearField)
    : nearField_(nearField), params_("gloss params", sizeof(layout::GlossParams), gpu::BufferUse::kDynamic) {}

void GlossPass::bind(const Inputs& inputs, const layout::GlossParams& params) {
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kGlossParams);
  bindPicture(inputs.gbuffer, inputs.sources, inputs.frameParams);
  inputs.buffer.points.bindStorage(layout::kGlossPoints);
}

/// Some blocks of pixels at a time.
GpuTask GlossPass::runBand(const Inputs& inputs, layout::GlossParams band, Pacing pacing) {
  const GlossSources& sources = inputs.sources;
  GlossBuffer& buffer = inputs.buffer;
  const glm::ivec2 blocks = partsOf({buffer.size.x, band.bandRows}, kBlock);
  const int count = blocks.x * blocks.y;
  gpu::Program& rays = rays_.get({.transparent = sources.shadows.occluders->transparent()});
  for (band.first = 0; band.first < count;) {
    const int wanted =
        std::clamp(int(pacing.unitsFor(Stage::kShade) / kTurnUnits), 1, std::min(kMostBlocks, count - band.first));
    buffer.list.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
    for (band.turn = 0; band.turn < sources.turns; ++band.turn) {
      band.last = band.turn + 1 == sources.turns ? 1 : 0;
      bind(inputs, band);
      inputs.seenLights.depth.bind(layout::kEmitterDepth);
      sources.points.view.bind(layout::kLightPoints);
      sources.shadows.occluders->bind();
      buffer.list.bindStorage(layout::kNearFieldPoints);
      rays.dispatch(std::uint32_t(wanted));
      gpu::memoryBarrier();
      co_yield submitted(Stage::kShade, wanted * kTurnUnits);
    }
    band.first += wanted;
    const MetPlaces met = {buffer.points,
                           buffer.list,
                           double(wanted) * kPointsOfBlock * layout::kGlossPlaces,
                           buffer.shadows,
                           buffer.met,
                           inputs.frameParams,
                           sources.firstRow + band.bandRow};
    co_await nearField_.lookFromMet(met, sources.emitters, sources.shadows, pacing);
  }
  const glm::ivec2 tiles = partsOf({buffer.size.x, band.rowsWanted}, kTile);
  bind(inputs, band);
  buffer.met.bind(layout::kGlossMet);
  buffer.lights.bindImage(layout::kGlossOut, GL_WRITE_ONLY);
  buffer.surfaces.bindImage(layout::kGlossSurfacesOut, GL_WRITE_ONLY);
  sum_.get({}).dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, 4.0 * buffer.size.x * band.rowsWanted);
}

GpuTask GlossPass::run(GlossBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                       const GlossSources& sources, const gpu::Buffer& frameParams, Pacing pacing) {
  const Inputs inputs = {buffer, gbuffer, seenLights, sources, frameParams};
  const int step = buffer.rows - 2 * layout::kGlossReach;
  for (int row = 0; row < buffer.size.y; row += step) {
    layout::GlossParams band{};
    band.firstRow = sources.firstRow;
    band.shadows = sources.shadowed ? 1 : 0;
    band.spacing = sources.spacing;
    band.bandRow = row - layout::kGlossReach;
    band.rowsWanted = std::min(step, buffer.size.y - row);
    band.bandRows = band.rowsWanted + 2 * layout::kGlossReach;
    co_await runBand(inputs, band, pacing);
  }
  const glm::ivec2 tiles = partsOf(buffer.size, kTile);
  bindPicture(gbuffer, sources, frameParams);
  buffer.lights.bind(layout::kGlossLights);
  buffer.surfaces.bind(layout::kGlossSurfaces);
  buffer.gloss.bindImage(layout::kGlossOut, GL_WRITE_ONLY);
  filter_.get({}).dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, 10.0 * buffer.size.x * buffer.size.y);
}

}  // namespace lpv
