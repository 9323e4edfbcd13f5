#include "lpv/frame/near_field.h"

#include <algorithm>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr glm::ivec2 kTile(layout::kNearFieldTile), kBlock(layout::kNearFieldBlockX, layout::kNearFieldBlockY);
static_assert(layout::kNearFieldBlockX * layout::kNearFieldBlockY == 32);  // bits of a uint

glm::ivec2 partsOf(const glm::ivec2& size, const glm::ivec2& part) { return (size + part - 1) / part; }

std::size_t count(const glm::ivec2& parts) { return std::size_t(parts.x) * std::size_t(parts.y); }

/// The finest pass has half of the pixels; each thread's last four may be incomplete.
std::size_t bytesOfPoints(const glm::ivec2& size) {
  return sizeof(layout::ListHeader) + 8 * count(partsOf(size, kBlock * glm::ivec2(1, 2))) * sizeof(glm::uvec4);
}

}  // namespace

struct NearFieldPass::Inputs {
  NearFieldBuffer& buffer;
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
    buffer.points.bindStorage(layout::kNearFieldPoints);
  }
};

struct NearFieldPass::Pass {
  int pass = LPV_PASS_WEIGHTS;
  glm::ivec2 part{0};     ///< pixels across and down of what a thread has
  glm::ivec2 stride{0};   ///< of NearFieldParams
  NearFieldWork work;     ///< of a thread
};

NearFieldBuffer::NearFieldBuffer(const glm::ivec2& s)
    : size(s),
      irradiance(gpu::Texture::make2d("near field", s, GL_RGBA32F, gpu::Sampling::kNearestClamp)),
      tiles("near field tiles", count(partsOf(s, kTile)) * sizeof(std::uint32_t)),
      points("near field points", bytesOfPoints(s), gpu::BufferUse::kDynamic, gpu::Undefined{}) {}

NearFieldPass::NearFieldPass()
    : params_("near field params", sizeof(layout::NearFieldParams), gpu::BufferUse::kDynamic) {}

/// Some parts at a time: what is to be evaluated in them, and its evaluation.
GpuTask NearFieldPass::run(const Inputs& inputs, const Pass& pass, Pacing pacing) {
  const int parts = int(count(partsOf(inputs.buffer.size, pass.part)));
  for (int first = 0; first < parts;) {
    const int wanted = std::clamp(int(pacing.unitsFor(Stage::kShade) / pass.work.units()), 1, parts - first);
    const int groups = (wanted + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup;
    const layout::NearFieldParams params = {.stride = pass.stride, .first = first, .pad0 = 0};
    const layout::ListHeader none = {.groupsX = 0, .groupsY = 1, .groupsZ = 1, .count = 0};
    params_.update(0, gpu::bytesOfValue(params));
    inputs.buffer.points.update(0, gpu::bytesOfValue(none));
    params_.bindUniform(layout::kNearFieldParams);
    inputs.bind();
    choose_.get({.pass = pass.pass}).dispatch(std::uint32_t(groups));
    gpu::memoryBarrier();
    if (pass.pass != LPV_PASS_WEIGHTS) {
      inputs.buffer.points.bindAsDispatchArguments();
      evaluate_.get({}).dispatchIndirect(0);
      gpu::memoryBarrier();
    }
    first += groups * layout::kNearFieldGroup;
    co_yield submitted(Stage::kShade, groups * layout::kNearFieldGroup * pass.work.units());
  }
}

GpuTask NearFieldPass::run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                           const NearLights& lights, const gpu::Buffer& frameParams, Pacing pacing) {
  const Inputs inputs = {buffer, gbuffer, seenLights, lights, frameParams};
  constexpr double kPoints = layout::kNearFieldBlockX * layout::kNearFieldBlockY;
  co_await run(inputs, {LPV_PASS_WEIGHTS, kTile, {0, 0}, {.weighed = double(kTile.x) * kTile.y}}, pacing);
  co_await run(inputs, {LPV_PASS_FIRST, kBlock * layout::kNearFieldSpacing, {0, 0}, {.evaluated = kPoints}}, pacing);
  for (int stride = layout::kNearFieldSpacing / 2; stride > 0; stride /= 2) {
    co_await run(inputs, {LPV_PASS_BETWEEN, kBlock * 2 * stride, {stride, 0}, {.between = kPoints}}, pacing);
    co_await run(inputs, {LPV_PASS_BETWEEN, kBlock * glm::ivec2(stride, 2 * stride), {0, stride}, {.between = kPoints}},
                 pacing);
  }
}

}  // namespace lpv
