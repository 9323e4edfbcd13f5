#include "lpv/transport/gather.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <utility>

#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr float kFarthest = 1e15F;       ///< stands for an infinite k: its square is a float

int roundsFor(const VplTree& tree, Sectors sectors) {
  return int(tree.entryCount) * (sectors == Sectors::kNone ? 1 : layout::kSectorRounds);
}

/// Sectors that one dispatch may walk for: all, unless their loops would take too many rounds.
int sectorsPerDispatch(const VplTree& tree, Sectors sectors) {
  if (sectors == Sectors::kNone) return 1;
  return roundsFor(tree, sectors) * kSectors <= layout::kMaxRounds ? kSectors : 1;
}

/// Walks that one dispatch may have to leave unfinished.
int dispatchesFor(const VplTree& tree, Sectors sectors) { return roundsFor(tree, sectors) / layout::kMaxRounds + 1; }

}  // namespace

/// A light, as receivers gather it.
struct Gatherer::Source {
  const LightVoxels& voxels;
  glm::dvec3 weight;  ///< of Palette
  double k;
  bool twoSided;
  std::uint32_t blocks;  ///< of receivers
  const gpu::Buffer* visibility;  ///< null where nothing stands in the way
};

/// Where a share of it goes.
struct Gatherer::Target {
  int layer;
  double share;
  Sectors sectors;
};

gpu::Defines Gatherer::Variant::defines() const {
  return {gpu::define("LPV_CHANNELS", channels), gpu::define("LPV_TEXTURED", textured),
          gpu::define("LPV_TWO_SIDED", twoSided), gpu::define("LPV_SECTORS", int(sectors)),
          gpu::define("LPV_SHADOWED", shadowed)};
}

Gatherer::Gatherer() : params_("gather params", sizeof(layout::GatherParams), gpu::BufferUse::kDynamic) {}

void Gatherer::bind(const LightField& field, const LightVoxels& voxels) {
  params_.bindUniform(layout::kParams);
  voxels.tree->texels.bind(layout::kTree);
  field.receivers.bindStorage(layout::kReceiverBlocks);
  field.cursors.bindStorage(layout::kCursors);
  field.emitterDistance.bindStorage(layout::kEmitterDistanceBuffer);
  field.transported().buffer.bindStorage(layout::kFieldOut);
}

GpuTask Gatherer::clear(LightField& field) {
  co_await fillChunked(field.pingPong[0].buffer);
  co_await fillChunked(field.emitterDistance, std::bit_cast<std::uint32_t>(layout::kFarFromVpls));
}

/// What is looked up of a light goes into the layers of its groups or the sectors', what is looked at into those apart.
std::vector<Gatherer::Target> Gatherer::targetsOf(const EmittingLight& light, const LightField& field,
                                                  Sectors sectors) {
  std::vector<Target> targets;
  const double moved = light.nextGroup == light.group ? 0.0 : light.moved;
  const auto add = [&](int group, double share) {
    if (share > 0.0) targets.push_back({group, share, sectors});
  };
  const double lookedAt = field.apart > 0 ? light.lookedAt : 0.0;
  for (const auto& [first, share] : {std::pair(0, 1.0 - lookedAt), {field.lookedUpGroups(), lookedAt}}) {
    add(first + light.group, share * (1.0 - moved));
    add(first + light.nextGroup, share * moved);
  }
  return targets;
}

/// What one light sends into one layer, or into all sectors.
GpuTask Gatherer::add(LightField& field, const Source& source, const Target& target, double& queued, Pacing pacing) {
  const LightVoxels& voxels = source.voxels;
  const bool byDirection = target.sectors != Sectors::kNone;
  const int allSectors = byDirection ? layout::kSectors : 1;
  layout::GatherParams params{};
  params.dims = field.grid.dims;
  params.weight = glm::vec3(target.share * voxels.radianceScale * source.weight);
  params.openingRatio = std::min(float(source.k), kFarthest);
  params.entryCount = int(voxels.tree->entryCount);
  params.firstChannel = target.layer * field.channels;  // the first of the sectors where layers are by direction
  gpu::Program& program = programs_.get({.channels = field.channels,
                                         .textured = voxels.momentsPerCell > 1,
                                         .twoSided = source.twoSided,
                                         .sectors = target.sectors,
                                         .shadowed = source.visibility != nullptr});
  const double units = GatherWork{1.0, 1.0, std::sqrt(double(voxels.tree->entryCount)), byDirection}.units();
  const int step = sectorsPerDispatch(*voxels.tree, target.sectors);
  const int turns = dispatchesFor(*voxels.tree, target.sectors);
  for (std::uint32_t first = 0; first < source.blocks;) {
    const double room = std::max(0.0, pacing.unitsFor(Stage::kGather) - queued);
    const std::uint32_t count =
        std::clamp<std::uint32_t>(std::uint32_t(std::min(room / units, 60000.0)), 1, source.blocks - first);
    params.firstBlock = first;
    for (int dispatch = 0; dispatch < allSectors / step * turns; ++dispatch) {
      params.turn = dispatch % turns;
      params.firstSector = dispatch / turns * step;
      params.sectorsEnd = params.firstSector + step;
      params_.update(0, gpu::bytesOfValue(params));
      bind(field, voxels);
      if (source.visibility != nullptr) source.visibility->bindStorage(layout::kCellVisibility);
      program.dispatch(count);
      gpu::memoryBarrier();
    }
    first += count;
    queued += count * units;
    if (queued < 0.9 * pacing.unitsFor(Stage::kGather)) continue;
    co_yield submitted(Stage::kGather, queued);
    queued = 0.0;
  }
}

GpuTask Gatherer::run(LightField& field, const std::vector<EmittingLight>& lights,
                      const std::vector<LightVoxelsPtr>& voxels, const Palette& palette, double k, Sectors sectors,
                      const ReceiverBlocks& blocks, const CellShadows* shadows, Pacing pacing) {
  field.receivers = gpu::Buffer("receiver blocks", gpu::bytesOf(std::span(blocks)));
  field.cursors = gpu::Buffer("cursors", blocks.size() * sizeof(glm::uvec2));
  double queued = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (voxels[i]->tree->entryCount == 0) continue;
    const gpu::Buffer* visibility = nullptr;
    if (shadows != nullptr) co_await visibility_.run(field, lights, i, *shadows, visibility, pacing);
    const Source source = {*voxels[i],         palette.weights[i],           k,
                           lights[i].twoSided, std::uint32_t(blocks.size()), visibility};
    const std::vector<Target> targets = targetsOf(lights[i], field, sectors);
    for (const Target& target : targets) co_await add(field, source, target, queued, pacing);
  }
  co_yield submitted(Stage::kGather, queued);
}

}  // namespace lpv
