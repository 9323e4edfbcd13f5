#include "lpv/frame/near_field.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

#include "gpu/gl.h"
#include "lpv/frame/parts.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

std::size_t count(const glm::ivec2& parts) { return std::size_t(parts.x) * std::size_t(parts.y); }

constexpr int kMostShadowPoints = 1 << 15;  // at a time: 368 bytes each
constexpr std::size_t kMostPoolBytes = std::size_t(64) << 20U;  // of the pictures of pools, a view
constexpr double kShareOffLattice = 0.35;  // of a picture's pixels that it is found at, about: for pacing
constexpr double kShareApart = 0.05;  // of a picture's pixels that have samples apart, about: for pacing
constexpr int kMostLightsOfEvenPoints = 4;  // in a pool: each must be met by a turn's rays

/// How many turns of rays go to a pool, and how many that see nothing say that it is dark.
struct PoolTurns {
  int most, dark;
};

/// A window shows a small share of a part of the sky, which the first rays of neighbours miss together: two boxes under
/// lamps lose nothing by four, a room by daylight lost a quarter of its light far from the window. So darkness is
/// believed later, and where some of it is seen, half as many rays again make up for the share's noise. Patches and the
/// points of streams are few: they go on to the end.
PoolTurns turnsFor(const LightPool& pool, int turns, bool patches, bool reduced) {
  if (!pool.distant || turns == 0) return {turns, 1};
  if (patches) return {turns, turns};
  if (reduced) return {2 * turns, 2 * turns};
  return {3 * turns / 2, std::max(turns / 4, 1)};
}

/// From the place of a turn's rays to the next one's: about .618 of all, so that the first few are spread, too, and
/// each comes once.
int turnStep(int turns) {
  int step = std::max(int(std::lround(0.618 * turns)), 1);
  while (std::gcd(step, turns) > 1) ++step;
  return step;
}

/// How many of so many patches send a point one sum (shaders/visibility/patch_sums.glsl).
int patchesOfBatch(int patches) {
  int batch = layout::kLeastPatchBatch;
  while (batch * layout::kPatchSumsOfPoint < patches) batch *= 2;
  return batch;
}

/// The finest pass between points has half of the pixels; each block's last four may be incomplete.
std::size_t bytesOfPoints(const glm::ivec2& size) {
  const std::size_t half = count(partsOf(size, kBlock * glm::ivec2(1, 2)));
  const std::size_t blocks = std::max<std::size_t>(half, kMostShadowPoints / kPointsOfBlock);
  return sizeof(layout::ListHeader) + blocks * kPointsOfBlock / 4 * sizeof(glm::uvec4);
}

}  // namespace

bool keepsPools(const glm::ivec2& size, std::size_t pools) {
  return count(size) * sizeof(glm::vec4) * pools <= kMostPoolBytes;
}

struct NearFieldPass::Inputs {
  NearFieldBuffer& buffer;
  const Gbuffer& gbuffer;
  const EmitterBuffer& seenLights;
  const NearFieldSources& sources;
  const gpu::Buffer& frameParams;
  std::optional<std::size_t> pool = std::nullopt;  ///< what is made is of it alone; none: of all together
  const gpu::Texture* poolPicture = nullptr;  ///< where it is kept; null: the buffer's
  int lattice = 1;  ///< of an unreduced picture: pixels from one that looks to the next, where what lies between may

  int spacing() const { return sources.reduced ? layout::kNearFieldSpacing : lattice; }
  bool everywhere() const { return sources.lights.emitterDistance == nullptr; }

  void bind() const {
    frameParams.bindUniform(layout::kParams);
    gbuffer.normal.bind(layout::kNormal);
    gbuffer.depth.bind(layout::kSurfaceDepth);
    seenLights.depth.bind(layout::kEmitterDepth);
    sources.lights.emitters->view.bind(layout::kDirect);
    if (!everywhere()) sources.lights.emitterDistance->bind(layout::kEmitterDistance);
    (poolPicture != nullptr ? *poolPicture : buffer.irradiance).bindImage(layout::kNearFieldOut, GL_READ_WRITE);
    buffer.tiles.bindStorage(layout::kNearFieldTiles);
    buffer.points.bindStorage(layout::kNearFieldPoints);
    if (!filtered() && !smoothed()) return;
    (filtered() ? buffer.poolLight : *poolPicture).bindImage(layout::kPoolLightOut, GL_WRITE_ONLY);
    buffer.poolShare.bindImage(layout::kPoolShareOut, GL_WRITE_ONLY);
  }
  /// Of lights, and one more if surfaces reflect.
  std::size_t pools() const {
    return sources.shadows->pools->pools.size() + (sources.shadows->reflected != nullptr ? 1 : 0);
  }
  /// The pools that are looked at, of those that there are.
  std::span<const LightPool> lookedAt() const {
    const std::span<const LightPool> all = sources.shadows->pools->pools;
    return pool ? all.subspan(std::min(*pool, all.size()), *pool < all.size() ? 1 : 0) : all;
  }
  bool looksAtReflections() const {
    return sources.shadows->reflected != nullptr && (!pool || *pool == sources.shadows->pools->pools.size());
  }
  /// Whether shares are smoothed over pixels: where each sends rays of its own.
  bool filtered() const { return sources.shadows != nullptr && !sources.reduced; }
  /// The same over points of a picture of what surfaces reflect, where rays are sent to some of its pixels.
  bool smoothed() const {
    return poolPicture != nullptr && looksAtReflections() && sources.shadows->reflectedTurns > 0;
  }
};

/// Receivers on a list that look at the lights through what may stand in the way.
struct NearFieldPass::Look {
  const ShadowCasters& shadows;
  std::span<const LightPool> pools;
  bool reflected;  ///< and at what surfaces reflect
  const gpu::Buffer& list;
  double points;  ///< on it, at most
  Receivers receivers;  ///< what they are
  bool reduced = false;  ///< rays go to the same places from every pixel, which are spread evenly
  bool smoothed = false;  ///< but for what surfaces reflect
  int firstRow = 0;  ///< of the pixels, in their picture
  ShadowPoints& known;
  std::function<void()> bind;
};

/// A pool of lights, or the patches.
struct NearFieldPass::LookAt {
  layout::ShadowParams params;
  const gpu::BufferTexture& points;
  bool reflected;
};

struct NearFieldPass::Pass {
  int pass = LPV_PASS_WEIGHTS;
  glm::ivec2 part{0};  ///< pixels across and down of what a thread has
  glm::ivec2 stride{0};  ///< of NearFieldParams
  NearFieldWork work;  ///< of a thread
  double points = double(kPointsOfBlock);  ///< that it lists, about

  /// The two that begin.
  static Pass weights() { return {LPV_PASS_WEIGHTS, kTile, {0, 0}, {.weighed = double(kTile.x) * kTile.y}}; }
  static Pass first(int spacing) {
    return {LPV_PASS_FIRST, kBlock * spacing, {0, 0}, {.evaluated = double(kPointsOfBlock)}};
  }
  static Pass lattice() {
    constexpr double kPoints = kShareOffLattice * kPointsOfBlock;
    return {LPV_PASS_LATTICE, kBlock, {0, 0}, {.evaluated = kPoints}, kPoints};
  }
};

NearFieldBuffer::NearFieldBuffer(const glm::ivec2& s)
    : size(s),
      irradiance(gpu::Texture::make2d("near field", s, GL_RGBA32F, gpu::Sampling::kNearestClamp)),
      tiles("near field tiles", count(partsOf(s, kTile)) * sizeof(std::uint32_t)),
      points("near field points", bytesOfPoints(s), gpu::BufferUse::kDynamic, gpu::Undefined{}) {}

void NearFieldBuffer::keepShadows() {
  constexpr std::size_t kGroupPoints = std::size_t(layout::kNearFieldGroup) * kPointsOfBlock;
  static_assert(kMostShadowPoints % kGroupPoints == 0);
  if (shadows) return;
  const std::size_t blocks = count(partsOf(size, kBlock));
  const std::size_t groups = (blocks + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup;
  shadows = ShadowPoints("shadow points", std::min<std::size_t>(groups * kGroupPoints, kMostShadowPoints));
}

NearFieldPass::NearFieldPass()
    : params_("near field params", sizeof(layout::NearFieldParams), gpu::BufferUse::kDynamic),
      shadowParams_("shadow params", sizeof(layout::ShadowParams), gpu::BufferUse::kDynamic) {}

/// One dispatch over a list of receivers.
struct NearFieldPass::LookStep {
  gpu::Program& program;
  int turn;
  double units;
};

std::vector<NearFieldPass::LookStep> NearFieldPass::stepsOf(const Look& from, const LookAt& at) {
  const ReceiverVariant receivers = {from.receivers};
  const RayVariant rays = {receivers, from.shadows.occluders->transparent()};
  const layout::ShadowParams& params = at.params;
  std::vector<LookStep> steps;
  steps.reserve(std::size_t(params.turns + params.foldTurns) + 2);
  if (at.reflected) {
    steps.push_back({reflected_.get(rays), -1, NearFieldWork{.fromPatches = from.points * params.pointCount}.units()});
    for (int turn = 0; turn < params.foldTurns; ++turn)
      steps.push_back({folds_.get(rays), turn, NearFieldWork{.rays = layout::kFoldRays * from.points}.units()});
  } else {
    steps.push_back({evaluate_.get({.shadowed = true, .receivers = receivers}), -1,
                     NearFieldWork{.evaluated = from.points}.units()});
  }
  for (int turn = 0; turn < params.turns; ++turn)
    steps.push_back({rays_.get({rays, at.reflected}), turn, NearFieldWork{.rays = 4.0 * from.points}.units()});
  steps.push_back({sum_.get(receivers), params.turns, NearFieldWork{.weighed = from.points}.units()});
  return steps;
}

layout::ShadowParams NearFieldPass::reflectedParams(const Look& from, layout::ShadowParams params) {
  const ShadowCasters& shadows = from.shadows;
  params.turns = shadows.reflectedTurns;
  params.turnStep = turnStep(params.turns);
  params.darkTurns = from.receivers == Receivers::kPatches ? params.turns : 1;
  params.foldTurns = params.turns > 0 && shadows.reflected->folded() ? shadows.foldTurns : 0;
  params.apart = from.smoothed ? 2 : 2 * params.apart;
  params.smoothedBy = from.smoothed ? layout::kNearFieldSpacing : params.jitter;
  params.pointCount = shadows.reflected->count;
  params.patchBatch = patchesOfBatch(params.pointCount);
  return params;
}

/// What is sent, how much of it arrives, and the sum so far.
GpuTask NearFieldPass::look(const Look& from, const LookAt& at, Pacing pacing) {
  layout::ShadowParams params = at.params;
  double queued = 0.0;
  for (const LookStep& step : stepsOf(from, at)) {
    params.turn = step.turn;
    shadowParams_.update(0, gpu::bytesOfValue(params));
    shadowParams_.bindUniform(layout::kShadowParams);
    from.bind();
    from.known.bind();
    at.points.bind(layout::kLightPoints);
    if (from.shadows.reflected != nullptr) from.shadows.reflected->bind();
    if (params.turns > 0) from.shadows.occluders->bind();
    from.list.bindAsDispatchArguments();
    step.program.dispatchIndirect(0);
    gpu::memoryBarrier();
    queued += step.units;
    if (queued < 0.9 * pacing.unitsFor(Stage::kShade)) continue;
    co_yield submitted(Stage::kShade, queued);
    queued = 0.0;
  }
  co_yield submitted(Stage::kShade, queued);
}

/// What surfaces reflect first, and then pool by pool: what is dim beside what has come before needs fewer rays.
GpuTask NearFieldPass::look(const Look& from, Pacing pacing) {
  const ShadowCasters& shadows = from.shadows;
  layout::ShadowParams params = {};
  params.pools = int(from.pools.size()) + (from.reflected ? 1 : 0);
  params.firstRow = from.firstRow;
  const bool patches = from.receivers == Receivers::kPatches && !from.reflected;
  params.jitter = from.reduced || patches ? 0 : 1;
  params.apart = from.receivers == Receivers::kPixels ? params.jitter : 0;
  if (from.reflected) {
    from.known.keepPatchSums();
    co_await look(from, {reflectedParams(from, params), shadows.reflected->lightTexels, true}, pacing);
    params.pool++;
  }
  const std::vector<std::size_t> order = brightestFirst(from.pools);
  for (const std::size_t i : order) {
    const LightPool& pool = from.pools[i];
    if (patches) params.jitter = pool.distant ? 1 : 0;
    const PoolTurns turns = turnsFor(pool, shadows.turns, patches, from.reduced);
    params.turns = turns.most;
    params.turnStep = turnStep(turns.most);
    params.darkTurns = turns.dark;
    params.smoothedBy = params.jitter;
    const bool few = pool.lightsEnd - pool.firstLight <= kMostLightsOfEvenPoints;
    params.even = (from.reduced && few) || pool.distant ? 1 : 0;  // distant points are spread by what they send
    params.firstLight = pool.firstLight;
    params.lightsEnd = pool.lightsEnd;
    params.firstPoint = pool.firstPoint;
    params.pointCount = pool.points;
    co_await look(from, {params, shadows.pools->view, false}, pacing);
    params.pool++;
  }
}

GpuTask NearFieldPass::lookFrom(PatchSet& patches, const PatchList& list, const EmitterBufferList& emitters,
                                const ShadowCasters& shadows, Pacing pacing) {
  const auto bind = [&patches, &list, &emitters] {
    emitters.view.bind(layout::kDirect);
    patches.bind();
    list.points.bindStorage(layout::kNearFieldPoints);
  };
  const bool reflected = shadows.reflected != nullptr;
  // Not a temporary: GCC 12 destroys it twice in co_await.
  const Look receivers = {.shadows = shadows,
                          .pools = reflected ? std::span<const LightPool>() : shadows.pools->pools,
                          .reflected = reflected,
                          .list = list.points,
                          .points = double(list.count),
                          .receivers = Receivers::kPatches,
                          .known = patches.shadows,
                          .bind = bind};
  co_await look(receivers, pacing);
}

GpuTask NearFieldPass::run(PatchSet& patches, const EmitterBufferList& emitters, const ShadowCasters& shadows,
                           Pacing pacing) {
  for (const PatchList& list : patches.points) co_await lookFrom(patches, list, emitters, shadows, pacing);
}

GpuTask NearFieldPass::lookFromMet(const MetPlaces& places, const EmitterBufferList& emitters,
                                   const ShadowCasters& shadows, Pacing pacing) {
  const auto bind = [&places, &emitters] {
    places.frameParams.bindUniform(layout::kParams);
    emitters.view.bind(layout::kDirect);
    places.points.bindStorage(layout::kGlossPoints);
    places.list.bindStorage(layout::kNearFieldPoints);
    places.irradiance.bindImage(layout::kNearFieldOut, GL_READ_WRITE);
  };
  const Look receivers = {.shadows = shadows,
                          .pools = shadows.pools->pools,
                          .reflected = shadows.reflected != nullptr,
                          .list = places.list,
                          .points = places.count,
                          .receivers = Receivers::kMet,
                          .firstRow = places.firstRow,
                          .known = places.shadows,
                          .bind = bind};
  co_await look(receivers, pacing);
}

GpuTask NearFieldPass::lookFromApart(NearFieldBuffer& buffer, const ApartPlaces& places,
                                     const EmitterBufferList& emitters, const ShadowCasters& shadows, Pacing pacing) {
  const auto bind = [&buffer, &places, &emitters] {
    places.frameParams.bindUniform(layout::kParams);
    emitters.view.bind(layout::kDirect);
    places.apart.albedo.bind(layout::kApartAlbedo);
    places.apart.place.bind(layout::kApartPlace);
    places.apart.normal.bind(layout::kApartNormal);
    places.apart.light.bindImage(layout::kNearFieldOut, GL_READ_WRITE);
    buffer.points.bindStorage(layout::kNearFieldPoints);
  };
  buffer.keepShadows();
  const int blocks = int(count(partsOf(places.apart.size(), kBlock)));
  const int most = int(buffer.shadows.count()) / kPointsOfBlock;  // places may be more than pixels
  for (int first = 0; first < blocks; first += most) {
    const int wanted = std::min(most, blocks - first);
    const layout::NearFieldParams params = {.stride = {0, 0}, .first = first, .spacing = 1};
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kNearFieldParams);
    buffer.points.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
    bind();
    listApart_.get({}).dispatch(std::uint32_t((wanted + layout::kNearFieldGroup - 1) / layout::kNearFieldGroup));
    gpu::memoryBarrier();
    const Look receivers = {.shadows = shadows,
                            .pools = shadows.pools->pools,
                            .reflected = shadows.reflected != nullptr,
                            .list = buffer.points,
                            .points = kShareApart * wanted * kPointsOfBlock,
                            .receivers = Receivers::kApart,
                            .firstRow = places.firstRow,
                            .known = buffer.shadows,
                            .bind = bind};
    co_await look(receivers, pacing);
  }
}

GpuTask NearFieldPass::lookFromPieces(PatchSet& patches, const EmitterBufferList& emitters,
                                      const ShadowCasters& shadows, Pacing pacing) {
  for (const PatchList& list : patches.piecePoints) co_await lookFrom(patches, list, emitters, shadows, pacing);
}

GpuTask NearFieldPass::filter(const Inputs& inputs, Pacing pacing) {
  const int tiles = int(count(partsOf(inputs.buffer.size, kTile)));
  constexpr double kUnits = 60.0 * layout::kNearFieldTile * layout::kNearFieldTile;  // of a tile: pixels shaded
  for (int first = 0; first < tiles;) {
    const int wanted = std::clamp(int(pacing.unitsFor(Stage::kShade) / kUnits), 1, tiles - first);
    const layout::NearFieldParams params = {.stride = {0, 0}, .first = first, .spacing = inputs.spacing()};
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kNearFieldParams);
    inputs.bind();
    inputs.buffer.poolLight.bind(layout::kPoolLight);
    inputs.buffer.poolShare.bind(layout::kPoolShare);
    filter_.get({.reflected = inputs.looksAtReflections()}).dispatch(std::uint32_t(wanted));
    gpu::memoryBarrier();
    first += wanted;
    co_yield submitted(Stage::kShade, wanted * kUnits);
  }
}

/// Pixels between those of the lattice, which have what they get.
GpuTask NearFieldPass::fill(const Inputs& inputs) {
  const glm::ivec2 groups = partsOf(inputs.buffer.size, kTile);
  const layout::NearFieldParams params = {.stride = {0, 0}, .first = 0, .spacing = inputs.spacing()};
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kNearFieldParams);
  inputs.bind();
  fill_.get({}).dispatch(std::uint32_t(groups.x), std::uint32_t(groups.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade, NearFieldWork{.weighed = double(count(inputs.buffer.size))}.units());
}

/// What the points of a pass get, from what they would get and the share that arrives at those around.
GpuTask NearFieldPass::smooth(const Inputs& inputs, const Pass& pass) {
  const int s = pass.stride.x + pass.stride.y;
  const glm::ivec2 apart = s == 0              ? glm::ivec2(inputs.spacing())
                           : pass.stride.x > 0 ? glm::ivec2(2 * s)
                                               : glm::ivec2(s, 2 * s);
  const glm::ivec2 groups = partsOf(partsOf(inputs.buffer.size, apart), kTile);
  const layout::NearFieldParams params = {.stride = pass.stride, .first = 0, .spacing = inputs.spacing()};
  params_.update(0, gpu::bytesOfValue(params));
  params_.bindUniform(layout::kNearFieldParams);
  inputs.bind();
  inputs.buffer.poolShare.bind(layout::kPoolShare);
  smooth_.get({}).dispatch(std::uint32_t(groups.x), std::uint32_t(groups.y));
  gpu::memoryBarrier();
  co_yield submitted(Stage::kShade,
                     NearFieldWork{.weighed = double(count(inputs.buffer.size)) / (apart.x * apart.y)}.units());
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
    choose_.get({.pass = pass.pass, .everywhere = inputs.everywhere(), .pool = inputs.poolPicture != nullptr})
        .dispatch(std::uint32_t(groups));
    gpu::memoryBarrier();
    first += groups * layout::kNearFieldGroup;
    if (shadowed) {
      const double points = double(groups) * layout::kNearFieldGroup * pass.points;
      const Look receivers = {.shadows = *inputs.sources.shadows,
                              .pools = inputs.lookedAt(),
                              .reflected = inputs.looksAtReflections(),
                              .list = inputs.buffer.points,
                              .points = points,
                              .receivers = Receivers::kPixels,
                              .reduced = inputs.sources.reduced,
                              .smoothed = inputs.smoothed(),
                              .firstRow = inputs.sources.firstRow,
                              .known = inputs.buffer.shadows,
                              .bind = [&inputs] { inputs.bind(); }};
      co_await look(receivers, pacing);
      continue;
    }
    if (!weighs) {
      inputs.buffer.points.bindAsDispatchArguments();
      evaluate_.get({.shadowed = false, .receivers = {}}).dispatchIndirect(0);
      gpu::memoryBarrier();
    }
    co_yield submitted(Stage::kShade, groups * layout::kNearFieldGroup * pass.work.units());
  }
}

GpuTask NearFieldPass::run(NearFieldBuffer& buffer, const Gbuffer& gbuffer, const EmitterBuffer& seenLights,
                           const NearFieldSources& sources, const gpu::Buffer& frameParams, Pacing pacing) {
  const Inputs inputs = {buffer, gbuffer, seenLights, sources, frameParams};
  if (sources.shadows != nullptr) buffer.keepShadows();
  const auto keep = [&buffer](gpu::Texture& picture, const char* label) {
    if (!picture) picture = gpu::Texture::make2d(label, buffer.size, GL_RGBA32F, gpu::Sampling::kNearestClamp);
  };
  if (inputs.filtered()) keep(buffer.poolLight, "light of a pool");
  if (inputs.filtered() || (!sources.pools.empty() && inputs.looksAtReflections()))
    keep(buffer.poolShare, "share of a pool");
  if (sources.pools.empty()) buffer.pools.clear();
  if (inputs.filtered()) {
    co_await runFiltered(inputs, pacing);
  } else if (sources.pools.empty()) {
    co_await runPasses(inputs, pacing);
  } else {
    co_await runPools(inputs, pacing);
  }
}

/// What surfaces reflect, and then pool by pool from every pixel, so that the share of each can be smoothed by itself.
GpuTask NearFieldPass::runFiltered(const Inputs& inputs, Pacing pacing) {
  co_await run(inputs, Pass::weights(), pacing);
  const std::size_t lights = inputs.sources.shadows->pools->pools.size();
  if (inputs.sources.shadows->reflected != nullptr) {
    inputs.buffer.poolShare.fill({0.0F, 0.0F, 0.0F, layout::kNoShare});
    Inputs part = inputs;
    part.pool = lights;
    part.lattice = inputs.sources.lattice;
    const bool between = part.lattice > 1;
    co_await run(part, between ? Pass::lattice() : Pass::first(1), pacing);
    co_await filter(part, pacing);
    if (between) co_await fill(part);
  }
  const std::vector<std::size_t> order = brightestFirst(inputs.sources.shadows->pools->pools);
  for (const std::size_t i : order) {
    Inputs part = inputs;
    part.pool = i;
    co_await run(part, Pass::first(1), pacing);
    co_await filter(part, pacing);
  }
}

/// Each pool by itself: what it sends stands while it, the camera and what is in its way do.
GpuTask NearFieldPass::runPools(const Inputs& inputs, Pacing pacing) {
  const glm::ivec2& size = inputs.buffer.size;
  const glm::ivec2 groups = partsOf(size, kTile);
  inputs.buffer.pools.resize(inputs.sources.pools.size());
  for (std::size_t i = 0; i < inputs.sources.pools.size(); ++i) {
    PoolPicture& known = inputs.buffer.pools[i];
    if (!known.madeFrom(inputs.sources.pools[i])) {
      gpu::Texture picture = std::move(known.product());
      known.forget();
      if (!picture) picture = gpu::Texture::make2d("pool of lights", size, GL_RGBA32F, gpu::Sampling::kNearestClamp);
      Inputs part = inputs;
      part.poolPicture = &picture;
      part.pool = i;
      co_await runPasses(part, pacing);
      known.set(inputs.sources.pools[i], std::move(picture));
    }
    const layout::NearFieldParams params = {.stride = {0, 0}, .first = int(i), .spacing = 1};
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kNearFieldParams);
    inputs.bind();
    known.product().bind(layout::kNearField);
    addPool_.get({}).dispatch(std::uint32_t(groups.x), std::uint32_t(groups.y));
    gpu::memoryBarrier();
    co_yield submitted(Stage::kShade, NearFieldWork{.weighed = double(count(size))}.units());
  }
}

GpuTask NearFieldPass::runSmoothed(const Inputs& inputs, const Pass& pass, Pacing pacing) {
  co_await run(inputs, pass, pacing);
  if (inputs.smoothed()) co_await smooth(inputs, pass);
}

GpuTask NearFieldPass::runPasses(const Inputs& inputs, Pacing pacing) {
  constexpr double kPoints = kPointsOfBlock;
  if (inputs.smoothed()) inputs.buffer.poolShare.fill({0.0F, 0.0F, 0.0F, layout::kNoShare});
  co_await run(inputs, Pass::weights(), pacing);
  co_await runSmoothed(inputs, Pass::first(inputs.spacing()), pacing);
  for (int stride = inputs.spacing() / 2; stride > 0; stride /= 2) {
    co_await runSmoothed(inputs, {LPV_PASS_BETWEEN, kBlock * 2 * stride, {stride, 0}, {.between = kPoints}}, pacing);
    co_await runSmoothed(
        inputs, {LPV_PASS_BETWEEN, kBlock * glm::ivec2(stride, 2 * stride), {0, stride}, {.between = kPoints}}, pacing);
  }
}

}  // namespace lpv
