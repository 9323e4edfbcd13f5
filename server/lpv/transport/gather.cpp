#include "lpv/transport/gather.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>

#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr float kFarthest = 1e15F;       ///< stands for an infinite k: its square is a float

/// Work of adding one channel of a block to another sum's, in the units of GatherWork.
constexpr double kUnitsPerChannel = 6.0;

/// Blocks of the next dispatch.
std::uint32_t piece(double most, std::uint32_t left) {
  return std::clamp<std::uint32_t>(std::uint32_t(std::min(most, 60000.0)), 1, left);
}

/// Walks that one dispatch may have to leave unfinished.
int dispatchesFor(const VplTree& tree) { return int(tree.entryCount) / layout::kMaxRounds + 1; }

}  // namespace

/// A light, as receivers gather it.
struct Gatherer::Source {
  const LightVoxels& voxels;
  glm::dvec3 weight;  ///< of Palette
  bool twoSided;
  const gpu::Buffer* visibility;  ///< null where nothing stands in the way
};

/// Where it is added to.
struct Gatherer::Into {
  gpu::Buffer& field;
  gpu::Buffer& emitterDistance;
};

/// What all coroutines of one run share.
struct Gatherer::Run {
  LightField& field;
  const GatheredLights& of;
  LightSums& sums;
  std::uint32_t blocks;  ///< of receivers
  std::size_t atOnce;    ///< lights
  Pacing pacing;
  double queued = 0.0;  ///< work that is not submitted yet

  std::uint32_t layersOf(const LightRange& range) const;
  double room() const { return std::max(0.0, pacing.unitsFor(Stage::kGather) - queued); }
  bool full() const { return queued >= 0.9 * pacing.unitsFor(Stage::kGather); }
};

/// The layers that it goes into, and the share of it that each gets.
struct Gatherer::Targets {
  std::array<int, layout::kGatherTargets> layers{};
  std::array<double, layout::kGatherTargets> shares{};
  int count = 0;
};

gpu::Defines Gatherer::Variant::defines() const {
  return {gpu::define("LPV_CHANNELS", channels), gpu::define("LPV_TEXTURED", textured),
          gpu::define("LPV_TWO_SIDED", twoSided), gpu::define("LPV_SECTORS", int(sectors)),
          gpu::define("LPV_SHADOWED", shadowed)};
}

Gatherer::Gatherer()
    : params_("gather params", sizeof(layout::GatherParams), gpu::BufferUse::kDynamic),
      sumParams_("gather sum params", sizeof(layout::GatherSumParams), gpu::BufferUse::kDynamic) {}

GpuTask Gatherer::clear(LightField& field) {
  co_await fillChunked(field.pingPong[0].buffer);
  co_await fillChunked(field.emitterDistance, std::bit_cast<std::uint32_t>(layout::kFarFromVpls));
}

/// What is looked up of a light goes into the layers of its groups or the sectors', what is looked at into those apart.
Gatherer::Targets Gatherer::targetsOf(const EmittingLight& light, const LightField& field) {
  Targets targets;
  const double moved = light.nextGroup == light.group ? 0.0 : light.moved;
  const auto add = [&](int layer, double share) {
    if (share <= 0.0) return;
    targets.layers[std::size_t(targets.count)] = layer;
    targets.shares[std::size_t(targets.count++)] = share;
  };
  const double lookedAt = field.apart > 0 ? light.lookedAt : 0.0;
  for (const auto& [first, share] : {std::pair(0, 1.0 - lookedAt), {field.lookedUpGroups(), lookedAt}}) {
    add(first + light.group, share * (1.0 - moved));
    add(first + light.nextGroup, share * moved);
  }
  return targets;
}

/// The layers that these lights are in, a bit each.
std::uint32_t Gatherer::Run::layersOf(const LightRange& range) const {
  if (of.sectors != Sectors::kNone) return (1U << unsigned(field.groups)) - 1U;
  std::uint32_t layers = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const Targets targets = targetsOf(of.lights[i], field);
    for (int target = 0; target < targets.count; ++target)
      layers |= 1U << unsigned(targets.layers[std::size_t(target)]);
  }
  return layers;
}

/// What one light sends into its layers.
GpuTask Gatherer::addSource(Run& run, const Source& source, const Targets& targets, Into to) {
  const LightVoxels& voxels = source.voxels;
  layout::GatherParams params{};
  params.dims = run.field.grid.dims;
  params.weight = glm::vec3(voxels.radianceScale * source.weight);
  params.openingRatio = std::min(float(run.of.k), kFarthest);
  params.entryCount = int(voxels.tree->entryCount);
  params.targets = targets.count;
  for (std::size_t i = 0; i < targets.layers.size(); ++i) {
    params.firstChannel[int(i)] = targets.layers[i] * run.field.channels;  // the first of the sectors
    params.share[int(i)] = float(targets.shares[i]);
  }
  gpu::Program& program = programs_.get({.channels = run.field.channels,
                                         .textured = voxels.momentsPerCell > 1,
                                         .twoSided = source.twoSided,
                                         .sectors = run.of.sectors,
                                         .shadowed = source.visibility != nullptr});
  const bool byDirection = run.of.sectors != Sectors::kNone;
  const double units = GatherWork{1.0, 1.0, std::sqrt(double(voxels.tree->entryCount)), byDirection}.units();
  const int turns = dispatchesFor(*voxels.tree);
  for (std::uint32_t first = 0; first < run.blocks;) {
    const std::uint32_t count = piece(run.room() / units, run.blocks - first);
    params.firstBlock = first;
    for (params.turn = 0; params.turn < turns; ++params.turn) {
      params_.update(0, gpu::bytesOfValue(params));
      params_.bindUniform(layout::kParams);
      voxels.tree->texels.bind(layout::kTree);
      run.field.receivers.bindStorage(layout::kReceiverBlocks);
      run.field.cursors.bindStorage(layout::kCursors);
      to.emitterDistance.bindStorage(layout::kEmitterDistanceBuffer);
      to.field.bindStorage(layout::kFieldOut);
      if (source.visibility != nullptr) source.visibility->bindStorage(layout::kCellVisibility);
      program.dispatch(count);
      gpu::memoryBarrier();
    }
    first += count;
    run.queued += count * units;
    if (!run.full()) continue;
    co_yield submitted(Stage::kGather, run.queued);
    run.queued = 0.0;
  }
}

GpuTask Gatherer::addLight(Run& run, std::size_t light, Into to) {
  const GatheredLights& of = run.of;
  if (of.voxels[light]->tree->entryCount == 0) co_return;
  const gpu::Buffer* visibility = nullptr;
  if (of.shadows != nullptr) co_await visibility_.run(run.field, of.lights, light, *of.shadows, visibility, run.pacing);
  const Source source = {*of.voxels[light], of.palette.weights[light], of.lights[light].twoSided, visibility};
  const Targets targets = targetsOf(of.lights[light], run.field);
  co_await addSource(run, source, targets, to);
}

GpuTask Gatherer::addSum(Run& run, const LightSum& sum, std::uint32_t layers, Into to) {
  layout::GatherSumParams params{};
  params.dims = run.field.grid.dims;
  params.channels = run.field.channels;
  params.layers = layers;
  const double units = kUnitsPerChannel * std::popcount(layers) * params.channels;
  for (std::uint32_t first = 0; first < run.blocks;) {
    const std::uint32_t count = piece(run.room() / units, run.blocks - first);
    params.firstBlock = first;
    sumParams_.update(0, gpu::bytesOfValue(params));
    sumParams_.bindUniform(layout::kParams);
    run.field.receivers.bindStorage(layout::kReceiverBlocks);
    to.field.bindStorage(layout::kFieldOut);
    sum.field.bindStorage(layout::kFieldSum);
    to.emitterDistance.bindStorage(layout::kEmitterDistanceBuffer);
    sum.emitterDistance.bindStorage(layout::kAddedDistance);
    sumProgram_.get({}).dispatch(count);
    gpu::memoryBarrier();
    first += count;
    run.queued += count * units;
    if (!run.full()) continue;
    co_yield submitted(Stage::kGather, run.queued);
    run.queued = 0.0;
  }
}

/// What is known of it, or a sum of its own, of the layers that the lights are in.
GpuTask Gatherer::half(Run& run, LightRange range, Into to, bool keep) {
  const std::uint32_t layers = run.layersOf(range);
  if (const LightSum* known = run.sums.known(range)) {
    co_await addSum(run, *known, layers, to);
    co_return;
  }
  LightSum own = run.sums.take(run.field);
  const std::size_t layerBytes = own.field.size() / std::size_t(run.field.groups);
  for (std::uint32_t left = layers; left != 0; left &= left - 1) {
    const Chunk layer = {std::size_t(std::countr_zero(left)) * layerBytes, layerBytes};
    co_await fillChunked(own.field, 0, layer);
  }
  co_await fillChunked(own.emitterDistance, std::bit_cast<std::uint32_t>(layout::kFarFromVpls));
  const bool kept = keep && run.sums.keeps(range);
  const Into into = {own.field, own.emitterDistance};
  co_await sum(run, range, into, keep && !kept);
  co_await addSum(run, own, layers, to);
  if (kept) {
    run.sums.keep(range, std::move(own));
  } else {
    run.sums.giveBack(std::move(own));
  }
}

/// Adds to zeros; so the first half needs no sum of its own where none is kept.
GpuTask Gatherer::sum(Run& run, LightRange range, Into to, bool keep) {
  if (range.count() <= run.atOnce) {
    for (std::size_t i = range.begin; i < range.end; ++i) co_await addLight(run, i, to);
    co_return;
  }
  const std::array<LightRange, 2> halves = halvesOf(range, run.atOnce);
  const bool inPlace = run.sums.known(halves[0]) == nullptr && !(keep && run.sums.keeps(halves[0]));
  if (inPlace) {
    co_await sum(run, halves[0], to, keep);
  } else {
    co_await half(run, halves[0], to, keep);
  }
  co_await half(run, halves[1], to, keep);
}

GpuTask Gatherer::run(LightField& field, const GatheredLights& lights, const ReceiverBlocks& blocks, LightSums& sums,
                      Pacing pacing) {
  field.receivers = gpu::Buffer("receiver blocks", gpu::bytesOf(std::span(blocks)));
  field.cursors = gpu::Buffer("cursors", blocks.size() * sizeof(glm::uvec2));
  gpu::Buffer& to = field.pingPong[0].buffer;
  const std::size_t count = lights.lights.size();
  if (count == 0) co_return;
  Run run = {field, lights, sums, std::uint32_t(blocks.size()), lightsAtOnce(count, to.size()), pacing};
  const Into into = {to, field.emitterDistance};
  const LightRange all = {0, count};
  co_await sum(run, all, into, true);
  co_yield submitted(Stage::kGather, run.queued);
}

}  // namespace lpv
