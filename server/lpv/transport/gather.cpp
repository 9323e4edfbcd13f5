#include "lpv/transport/gather.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

constexpr float kFarthest = 1e15F;       ///< stands for an infinite k: its square is a float

layout::GatherParams paramsOf(const LightField& field, const EmittingLight& light, const LightVoxels& voxels,
                              const glm::dvec3& weight, double k) {
  layout::GatherParams params{};
  params.dims = field.grid.dims;
  params.weight = glm::vec3(weight * voxels.radianceScale);
  params.openingRatio = std::min(float(k), kFarthest);
  params.entryCount = int(voxels.tree->entryCount);
  params.firstChannel = light.group * field.channels;  // group 0 where layers are by direction
  return params;
}

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

GpuTask Gatherer::run(LightField& field, const std::vector<EmittingLight>& lights,
                      const std::vector<LightVoxelsPtr>& voxels, const Palette& palette, double k, Sectors sectors,
                      const ReceiverBlocks& blocks, const CellShadows* shadows, Pacing pacing) {
  const bool byDirection = sectors != Sectors::kNone;
  const int allSectors = byDirection ? layout::kSectors : 1;
  const auto blockCount = std::uint32_t(blocks.size());
  field.receivers = gpu::Buffer("receiver blocks", gpu::bytesOf(std::span(blocks)));
  field.cursors = gpu::Buffer("cursors", blocks.size() * sizeof(glm::uvec2));
  double queued = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const LightVoxels& light = *voxels[i];
    if (light.tree->entryCount == 0) continue;
    const gpu::Buffer* visibility = nullptr;
    if (shadows != nullptr) co_await visibility_.run(field, lights, i, *shadows, visibility, pacing);
    layout::GatherParams params = paramsOf(field, lights[i], light, palette.weights[i], k);
    gpu::Program& program = programs_.get({.channels = field.channels,
                                           .textured = light.momentsPerCell > 1,
                                           .twoSided = lights[i].twoSided,
                                           .sectors = sectors,
                                           .shadowed = shadows != nullptr});
    const double units = GatherWork{1.0, 1.0, std::sqrt(double(light.tree->entryCount)), byDirection}.units();
    const int step = sectorsPerDispatch(*light.tree, sectors), turns = dispatchesFor(*light.tree, sectors);
    for (std::uint32_t first = 0; first < blockCount;) {
      const double room = std::max(0.0, pacing.unitsFor(Stage::kGather) - queued);
      const std::uint32_t count =
          std::clamp<std::uint32_t>(std::uint32_t(std::min(room / units, 60000.0)), 1, blockCount - first);
      params.firstBlock = first;
      for (int dispatch = 0; dispatch < allSectors / step * turns; ++dispatch) {
        params.turn = dispatch % turns;
        params.firstSector = dispatch / turns * step;
        params.sectorsEnd = params.firstSector + step;
        params_.update(0, gpu::bytesOfValue(params));
        bind(field, light);
        if (visibility != nullptr) visibility->bindStorage(layout::kCellVisibility);
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
  co_yield submitted(Stage::kGather, queued);
}

}  // namespace lpv
