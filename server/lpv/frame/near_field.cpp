#include "lpv/frame/near_field.h"

#include <algorithm>

#include "gpu/gl.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr glm::ivec2 kTile(layout::kNearFieldTile), kBlock(layout::kNearFieldBlockX, layout::kNearFieldBlockY);

glm::ivec2 partsOf(const glm::ivec2& size, const glm::ivec2& part) { return (size + part - 1) / part; }

std::size_t count(const glm::ivec2& parts) { return std::size_t(parts.x) * std::size_t(parts.y); }

constexpr int kPointsOfBlock = layout::kNearFieldBlockX * layout::kNearFieldBlockY;
static_assert(kPointsOfBlock == 32);  // bits of a uint
constexpr std::size_t kShadowPointBytes = 4 * sizeof(glm::vec4);  // of shaders/visibility/shadow_points.glsl
constexpr int kMostShadowPoints = 1 << 16;  // at a time: their memory

/// The finest pass between points has half of the pixels; each block's last four may be incomplete.
std::size_t bytesOfPoints(const glm::ivec2& size) {
  const std::size_t half = count(partsOf(size, kBlock * glm::ivec2(1, 2)));
  const std::size_t blocks = std::max<std::size_t>(half, kMostShadowPoints / kPointsOfBlock);
  return sizeof(layout::ListHeader) + blocks * kPointsOfBlock / 4 * sizeof(glm::uvec4);
}

}  // namespace

struct NearFieldPass::Inputs {
  NearFieldBuffer& buffer;
  const Gbuffer& gbuffer;
  const EmitterBuffer& seenLights;
  const NearFieldSources& sources;
  const gpu::Buffer& frameParams;

  int spacing() const { return sources.reduced ? layout::kNearFieldSpacing : 1; }
  bool everywhere() const { return sources.lights.emitterDistance == nullptr; }

  void bind() const {
    frameParams.bindUniform(layout::kParams);
    gbuffer.normal.bind(layout::kNormal);
    gbuffer.depth.bind(layout::kSurfaceDepth);
    seenLights.depth.bind(layout::kEmitterDepth);
    sources.lights.emitters->view.bind(layout::kDirect);
    if (!everywhere()) sources.lights.emitterDistance->bind(layout::kEmitterDistance);
    buffer.irradiance.bindImage(layout::kNearFieldOut, GL_READ_WRITE);
    buffer.tiles.bindStorage(layout::kNearFieldTiles);
    buffer.points.bindStorage(layout::kNearFieldPoints);
    if (sources.shadows == nullptr) return;
    buffer.shadows.bindStorage(layout::kShadowPoints);
    sources.shadows->pools->view.bind(layout::kLightPoints);
    sources.shadows->occluders->bind();
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
    : params_("near field params", sizeof(layout::NearFieldParams), gpu::BufferUse::kDynamic),
      shadowParams_("shadow params", sizeof(layout::ShadowParams), gpu::BufferUse::kDynamic) {}

/// Light at the points that were listed, pool by pool: what each sends, how much of it arrives, and the sum.
GpuTask NearFieldPass::lookThroughShadows(const Inputs& inputs, double points, Pacing pacing) {
  const ShadowCasters& shadows = *inputs.sources.shadows;
  const std::vector<LightPool>& pools = shadows.pools->pools;
  layout::ShadowParams params = {};
  params.turns = shadows.turns;
  params.pools = int(pools.size());
  params.jitter = inputs.sources.reduced ? 0 : 1;
  double queued = 0.0;
  const auto dispatch = [&](gpu::Program& program, const NearFieldWork& work) {
    shadowParams_.update(0, gpu::bytesOfValue(params));
    shadowParams_.bindUniform(layout::kShadowParams);
    inputs.bind();
    inputs.buffer.points.bindAsDispatchArguments();
    program.dispatchIndirect(0);
    gpu::memoryBarrier();
    queued += work.units();
    return queued > pacing.unitsFor(Stage::kShade);
  };
  for (const LightPool& pool : pools) {
    params.firstLight = pool.firstLight;
    params.lightsEnd = pool.lightsEnd;
    params.firstPoint = pool.firstPoint;
    params.pointCount = pool.points;
    for (params.turn = -1; params.turn <= params.turns; ++params.turn) {
      const bool evaluates = params.turn < 0, sums = params.turn == params.turns;
      gpu::Program& program = evaluates ? evaluate_.get({.shadowed = true}) : sums ? sum_.get({}) : rays_.get({});
      if (!dispatch(program, {.weighed = sums ? points : 0.0, .evaluated = evaluates ? points : 0.0,
                              .rays = evaluates || sums ? 0.0 : 4.0 * points}))
        continue;
      co_yield submitted(Stage::kShade, queued);
      queued = 0.0;
    }
    params.pool++;
  }
  co_yield submitted(Stage::kShade, queued);
}

/// Some parts at a time: what is to be evaluated in them, and its evaluation.
GpuTask NearFieldPass::run(const Inputs& inputs, const Pass& pass, Pacing pacing) {
  const int parts = int(count(partsOf(inputs.buffer.size, pass.part)));
  const bool weighs = pass.pass == LPV_PASS_WEIGHTS, shadowed = !weighs && inputs.sources.shadows != nullptr;
  const int most = shadowed ? kMostShadowPoints / kPointsOfBlock : parts;
  for (int first = 0; first < parts;) {
    const int wanted =
        std::clamp(int(pacing.unitsFor(Stage::kShade) / pass.work.units()), 1, std::min(most, parts - first));
    const int groups = (wanted + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup;
    const layout::NearFieldParams params = {.stride = pass.stride, .first = first, .spacing = inputs.spacing()};
    const layout::ListHeader none = {.groupsX = 0, .groupsY = 1, .groupsZ = 1, .count = 0};
    params_.update(0, gpu::bytesOfValue(params));
    inputs.buffer.points.update(0, gpu::bytesOfValue(none));
    params_.bindUniform(layout::kNearFieldParams);
    inputs.bind();
    choose_.get({.pass = pass.pass, .everywhere = inputs.everywhere()}).dispatch(std::uint32_t(groups));
    gpu::memoryBarrier();
    first += groups * layout::kNearFieldGroup;
    if (shadowed) {
      co_await lookThroughShadows(inputs, double(groups) * layout::kNearFieldGroup * kPointsOfBlock, pacing);
      continue;
    }
    if (!weighs) {
      inputs.buffer.points.bindAsDispatchArguments();
      evaluate_.get({.shadowed = false}).dispatchIndirect(0);
      gpu::memoryBarrier();
    }
    co_yield submitted(Stage::kShade, groups * layout::kNearFieldGroup * pass.work.units());
  }
}

GpuTask NearFieldPass::run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                           const NearFieldSources& sources, const gpu::Buffer& frameParams, Pacing pacing) {
  const Inputs inputs = {buffer, gbuffer, seenLights, sources, frameParams};
  if (sources.shadows != nullptr && !buffer.shadows)
    buffer.shadows = gpu::Buffer("shadow points", kMostShadowPoints * kShadowPointBytes, gpu::BufferUse::kDevice,
                                 gpu::Undefined{});
  constexpr double kPoints = kPointsOfBlock;
  co_await run(inputs, {LPV_PASS_WEIGHTS, kTile, {0, 0}, {.weighed = double(kTile.x) * kTile.y}}, pacing);
  co_await run(inputs, {LPV_PASS_FIRST, kBlock * inputs.spacing(), {0, 0}, {.evaluated = kPoints}}, pacing);
  for (int stride = inputs.spacing() / 2; stride > 0; stride /= 2) {
    co_await run(inputs, {LPV_PASS_BETWEEN, kBlock * 2 * stride, {stride, 0}, {.between = kPoints}}, pacing);
    co_await run(inputs, {LPV_PASS_BETWEEN, kBlock * glm::ivec2(stride, 2 * stride), {0, stride}, {.between = kPoints}},
                 pacing);
  }
}

}  // namespace lpv
