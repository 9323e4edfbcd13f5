#include "lpv/frame/gloss.h"

#include <algorithm>

#include "gpu/gl.h"
#include "lpv/frame/parts.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr int kMostBlocks = 2048;  // at a time: the memory of what is known of places that are met
constexpr std::size_t kMostGlossPlaces = std::size_t(kMostBlocks) * kPointsOfBlock * layout::kGlossPlaces;
constexpr std::size_t kGlossPointBytes = 4 * sizeof(glm::vec4);

gpu::Texture glossPicture(const char* label, const glm::ivec2& size) {
  return gpu::Texture::make2d(label, size, GL_RGBA32F, gpu::Sampling::kNearestClamp);
}

gpu::Buffer deviceBuffer(const char* label, std::size_t bytes) {
  return {label, bytes, gpu::BufferUse::kDevice, gpu::Undefined{}};
}

/// In shaded pixels, about what a turn of a block takes on llvmpipe.
constexpr double kTurnUnits = 10.0 * 2 * layout::kGlossRays * kPointsOfBlock;

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
      gloss(glossPicture("gloss", s)),
      lights(glossPicture("gloss of lights", s)),
      surfaces(glossPicture("gloss of surfaces", s)),
      met(glossPicture("light where reflections met", {layout::kGlossPlaces * s.x, s.y})),
      points(
          deviceBuffer("reflections", layout::kGlossPlaces * std::size_t(s.x) * std::size_t(s.y) * kGlossPointBytes)),
      list("places that reflections met", sizeof(layout::ListHeader) + kMostGlossPlaces / 4 * sizeof(glm::uvec4),
           gpu::BufferUse::kDynamic, gpu::Undefined{}),
      shadows(deviceBuffer("shadow points of reflections", kMostGlossPlaces * kShadowPointTexels * sizeof(glm::vec4))) {
}

GlossPass::GlossPass(NearFieldPass& nearField)
    : nearField_(nearField), params_("gloss params", sizeof(layout::GlossParams), gpu::BufferUse::kDynamic) {}

/// Some blocks of pixels at a time: all turns of rays, then the light at the places that were met.
GpuTask GlossPass::run(GlossBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                       const GlossSources& sources, const gpu::Buffer& frameParams, Pacing pacing) {
  const glm::ivec2 blocks = partsOf(buffer.size, kBlock);
  const int count = blocks.x * blocks.y;
  gpu::Program& rays = rays_.get({.transparent = sources.shadows.occluders->transparent()});
  for (int first = 0; first < count;) {
    const int wanted =
        std::clamp(int(pacing.unitsFor(Stage::kShade) / kTurnUnits), 1, std::min(kMostBlocks, count - first));
    buffer.list.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
    for (int turn = 0; turn < sources.turns; ++turn) {
      layout::GlossParams params{};
      params.first = first;
      params.turn = turn;
      params.turns = sources.turns;
      params.firstRow = sources.firstRow;
      params.shadows = sources.shadowed ? 1 : 0;
      params.last = turn + 1 == sources.turns ? 1 : 0;
      params_.update(0, gpu::bytesOfValue(params));
      bindPicture(gbuffer, sources, frameParams);
      params_.bindUniform(layout::kGlossParams);
      seenLights.depth.bind(layout::kEmitterDepth);
      sources.shadows.pools->view.bind(layout::kLightPoints);
      sources.shadows.occluders->bind();
      buffer.points.bindStorage(layout::kGlossPoints);
      buffer.list.bindStorage(layout::kNearFieldPoints);
      rays.dispatch(std::uint32_t(wanted));
      gpu::memoryBarrier();
      co_yield submitted(Stage::kShade, wanted * kTurnUnits);
    }
    first += wanted;
    const MetPlaces met = {buffer.points,   buffer.list, double(wanted) * kPointsOfBlock * layout::kGlossPlaces,
                           buffer.shadows,  buffer.met,  frameParams,
                           sources.firstRow};
    co_await nearField_.lookFromMet(met, sources.emitters, sources.shadows, pacing);
  }
  const glm::ivec2 tiles = partsOf(buffer.size, kTile);
  const double pixels = double(buffer.size.x) * buffer.size.y;
  bindPicture(gbuffer, sources, frameParams);
  buffer.points.bindStorage(layout::kGlossPoints);
  buffer.met.bind(layout::kGlossMet);
  buffer.lights.bindImage(layout::kGlossOut, GL_WRITE_ONLY);
  buffer.surfaces.bindImage(layout::kGlossSurfacesOut, GL_WRITE_ONLY);
  sum_.get({}).dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, pixels);
  bindPicture(gbuffer, sources, frameParams);
  buffer.lights.bind(layout::kGlossLights);
  buffer.surfaces.bind(layout::kGlossSurfaces);
  buffer.gloss.bindImage(layout::kGlossOut, GL_WRITE_ONLY);
  filter_.get({}).dispatch(std::uint32_t(tiles.x), std::uint32_t(tiles.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, 10.0 * pixels);
}

}  // namespace lpv
