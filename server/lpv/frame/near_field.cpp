#include "lpv/frame/near_field.h"

#include <algorithm>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr glm::ivec2 kTile{layout::kNearFieldTileX, layout::kNearFieldTileY};

glm::ivec2 tilesOf(const glm::ivec2& size) { return (size + kTile - 1) / kTile; }

/// Points that a tile has in one dispatch: at every `spacing`-th pixel, or those between.
double pointsPerTile(const glm::ivec2& stride) {
  const double pixels = double(kTile.x) * kTile.y;
  if (stride == glm::ivec2(0)) return pixels;  // of each the weight
  return stride.x > 0 ? pixels / (4.0 * stride.x * stride.x) : pixels / (2.0 * stride.y * stride.y);
}

}  // namespace

struct NearFieldPass::Inputs {
  const NearFieldBuffer& buffer;
  const Gbuffer& gbuffer;
  const EmitterBuffer& seenLights;
  const NearLights& lights;
  const gpu::Buffer& frameParams;

  void bind() const {
    frameParams.bindUniform(layout::kParams);
    gbuffer.normal.bind(layout::kNormal);
    gbuffer.depth.bind(layout::kSurfaceDepth);
    seenLights.depth.bind(layout::kEmitterDepth);
    lights.emitters->view.bind(layout::kDirect);
    lights.emitterDistance->bind(layout::kEmitterDistance);
    buffer.irradiance.bindImage(layout::kNearFieldOut, GL_READ_WRITE);
    buffer.tiles.bindStorage(layout::kNearFieldTiles);
  }
};

NearFieldBuffer::NearFieldBuffer(const glm::ivec2& s)
    : size(s),
      irradiance(gpu::Texture::make2d("near field", s, GL_RGBA32F, gpu::Sampling::kNearestClamp)),
      tiles("near field tiles", std::size_t(tilesOf(s).x) * std::size_t(tilesOf(s).y) * sizeof(std::uint32_t)) {}

NearFieldPass::NearFieldPass()
    : params_("near field params", sizeof(layout::NearFieldParams), gpu::BufferUse::kDynamic) {}

/// Rows of tiles at a time.
GpuTask NearFieldPass::dispatch(const Inputs& inputs, const glm::ivec2& stride, Pacing pacing) {
  const glm::ivec2 tiles = tilesOf(inputs.buffer.size);
  const double perRow = pointsPerTile(stride) * tiles.x;
  for (int row = 0; row < tiles.y;) {
    const int rows = std::clamp(int(pacing.unitsFor(Stage::kShade) / perRow), 1, tiles.y - row);
    const layout::NearFieldParams params = {.stride = stride, .firstRow = row, .pad0 = 0};
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kNearFieldParams);
    inputs.bind();
    programs_.get({.first = stride == glm::ivec2(0)}).dispatch(std::uint32_t(tiles.x), std::uint32_t(rows));
    gpu::memoryBarrier();
    row += rows;
    co_yield submitted(Stage::kShade, NearFieldWork{perRow * rows}.units());
  }
}

GpuTask NearFieldPass::run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                           const NearLights& lights, const gpu::Buffer& frameParams, Pacing pacing) {
  const Inputs inputs = {buffer, gbuffer, seenLights, lights, frameParams};
  buffer.tiles.clear();
  co_await dispatch(inputs, {0, 0}, pacing);
  for (int stride = layout::kNearFieldSpacing / 2; stride > 0; stride /= 2) {
    co_await dispatch(inputs, {stride, 0}, pacing);
    co_await dispatch(inputs, {0, stride}, pacing);
  }
}

}  // namespace lpv
