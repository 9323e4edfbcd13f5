#include "lpv/transport/cell_visibility.h"

#include <algorithm>
#include <utility>

namespace lpv {

namespace {

constexpr std::size_t kMostKeptBytes = std::size_t(64) << 20U;
constexpr int kTurnsOfDistant = 8;  ///< times as many: of what is seen through windows rays miss most

CellVisibilityInputs inputsOf(const EmittingLight& light, std::size_t index, const glm::ivec3& dims,
                              const CellShadows& shadows) {
  CellVisibilityInputs inputs = {light.emission(), int(index), dims, shadows.turns, shadows.occluders->surfaces()};
  inputs.light.radiance = glm::dvec3(0.0);
  inputs.light.group.clear();
  return inputs;
}

}  // namespace

int cellTurns(Quality quality, std::size_t lights) {
  const int turns = quality == Quality::kAccurate ? 8 : 4;
  return lights <= 4 ? turns : turns / 2;
}

CellVisibilityPass::CellVisibilityPass()
    : params_("cell visibility params", sizeof(layout::CellVisibilityParams), gpu::BufferUse::kDynamic) {}

/// All turns for some blocks, then the next blocks.
GpuTask CellVisibilityPass::sendRays(layout::CellVisibilityParams params, const CellShadows& shadows,
                                     const gpu::Buffer& out, Pacing pacing) {
  const glm::ivec3 blockSize(layout::kBlockX, layout::kBlockY, layout::kBlockZ);
  params.blocks = (params.dims + blockSize - 1) / blockSize;
  params.turns = params.toTheEnd == 1 ? kTurnsOfDistant * shadows.turns : shadows.turns;
  const int blocks = params.blocks.x * params.blocks.y * params.blocks.z;
  const CellVisibilityWork block = {double(blockSize.x) * blockSize.y * blockSize.z, 1.0, 1.0};
  double queued = 0.0;
  for (int first = 0; first < blocks;) {
    const int count = std::clamp(int(pacing.unitsFor(Stage::kVisibility) / block.units()), 1, blocks - first);
    params.firstBlock = first;
    for (params.turn = 0; params.turn < params.turns; ++params.turn) {
      params_.update(0, gpu::bytesOfValue(params));
      params_.bindUniform(layout::kParams);
      shadows.points->view.bind(layout::kLightPoints);
      shadows.occluders->bind();
      out.bindStorage(layout::kCellVisibility);
      program_.get({shadows.occluders->transparent()}).dispatch(std::uint32_t(count));
      gpu::memoryBarrier();
      queued += count * block.units();
      if (queued < 0.9 * pacing.unitsFor(Stage::kVisibility)) continue;
      co_yield submitted(Stage::kVisibility, queued);
      queued = 0.0;
    }
    first += count;
  }
  co_yield submitted(Stage::kVisibility, queued);
}

GpuTask CellVisibilityPass::run(const LightField& field, const std::vector<EmittingLight>& lights, std::size_t light,
                                const CellShadows& shadows, const gpu::Buffer*& out, Pacing pacing) {
  const std::size_t bytes = field.grid.cells() * sizeof(layout::CellVisibility);
  auto& kept = shadows.known->lights;
  kept.resize(bytes * lights.size() <= kMostKeptBytes ? lights.size() : 1);
  auto& known = kept[light % kept.size()];
  const glm::ivec3& dims = field.grid.dims;
  CellVisibilityInputs inputs = inputsOf(lights[light], light, dims, shadows);
  if (!known.madeFrom(inputs)) {
    gpu::Buffer buffer = std::move(known.product());
    known.forget();
    if (buffer.size() < bytes)
      buffer = gpu::Buffer("cell visibility", bytes, gpu::BufferUse::kDevice, gpu::Undefined{});
    const LightPool& points = shadows.points->ranges[light];
    layout::CellVisibilityParams params = {};
    params.dims = dims;
    params.firstPoint = points.firstPoint;
    params.pointCount = points.points;
    params.light = int(light);
    params.toTheEnd = points.distant ? 1 : 0;  // seen through windows: first rays miss what few of them meet
    co_await sendRays(params, shadows, buffer, pacing);
    known.set(std::move(inputs), std::move(buffer));
  }
  out = &known.product();
}

}  // namespace lpv
