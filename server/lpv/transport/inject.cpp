#include "lpv/transport/inject.h"

#include <utility>

#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

double unitsOf(const LightVoxels& voxels) {
  if (voxels.tree == nullptr) return InjectWork{1.0, double(voxels.capacity)}.units();
  const glm::dvec3 size(voxels.tree->box.upper - voxels.tree->box.lower);
  return InjectWork{1.0, size.x * size.y * size.z}.units();
}

layout::InjectParams whereOf(const LightField& field, const LightVoxels& voxels) {
  layout::InjectParams params{};
  params.dims = field.grid.dims;
  params.group = voxels.group;
  return params;
}

layout::InjectParams paramsOf(const LightField& field, const EmittingLight& light, const LightVoxels& voxels,
                              const glm::dvec3& weight) {
  layout::InjectParams params{};
  params.dims = field.grid.dims;
  params.group = light.group;
  const double face = field.grid.cell * field.grid.cell;  // m^2
  params.weight = glm::vec3(weight * (face * voxels.areaScale * voxels.radianceScale));
  params.sides = light.twoSided ? 2.0F : 1.0F;
  params.band1Factor = light.twoSided ? 0.0F : 1.0F;
  return params;
}

/// Where a light's tree lies; the cells of `inner`, the product's, that its box meets.
CellBox placeVpls(const LightVoxels& voxels, const CellBox& inner, layout::InjectParams& params) {
  const CellBox& box = voxels.tree->box;
  const double cell = voxels.source.cell;
  const glm::dvec3 origin = voxels.source.origin, first(inner.lower), last(inner.upper - 1);
  const glm::dvec3 lower = origin + cell * glm::dvec3(box.lower), upper = origin + cell * glm::dvec3(box.upper);
  // What lies on the outer upper faces belongs to the last cells.
  if (glm::any(glm::greaterThan(lower, last + 1.0)) || glm::any(glm::lessThanEqual(upper, first))) return {};
  const CellBox cells = {glm::ivec3(glm::clamp(glm::floor(lower), first, last)),
                         glm::ivec3(glm::clamp(glm::ceil(upper) - 1.0, first, last)) + 1};
  params.upper = inner.upper;
  params.cell = float(cell);
  params.origin = glm::vec3(origin);
  params.boxLower = box.lower;
  params.boxSize = box.upper - box.lower;
  params.firstCell = cells.lower;
  params.cellCount = cells.upper - cells.lower;
  return cells;
}

std::uint32_t groupsFor(const CellBox& cells) {
  const glm::ivec3 size = cells.upper - cells.lower;
  return std::uint32_t((size.x * size.y * size.z + layout::kCellGroup - 1) / layout::kCellGroup);
}

}  // namespace

gpu::Defines Injector::VplVariant::defines() const {
  return {gpu::define("LPV_CHANNELS", channels), gpu::define("LPV_TEXTURED", textured)};
}

gpu::Defines Injector::Variant::defines() const {
  gpu::Defines out = light.defines();
  if (passes.retire) out.push_back(gpu::define("LPV_RETIRE", 1));
  if (passes.add) out.push_back(gpu::define("LPV_ADD", 1));
  if (passes.divide) out.push_back(gpu::define("LPV_DIVIDE", 1));
  return out;
}

Injector::Injector() : params_("inject params", sizeof(layout::InjectParams), gpu::BufferUse::kDynamic) {}

void Injector::dispatch(LightField& field, const LightVoxels& voxels, Passes passes) {
  params_.bindUniform(layout::kParams);
  field.injected.buffer.bindStorage(layout::kFieldOut);
  field.lobeCounts.bindStorage(layout::kLobeCounts);
  field.counters.bindStorage(layout::kCounters);
  voxels.cells.bindStorage(layout::kVoxelCells);
  voxels.moments.bindStorage(layout::kVoxelMoments);
  voxels.cells.bindAsDispatchArguments();
  programs_.get({.light = {field.channels, voxels.momentsPerCell > 1}, .passes = passes}).dispatchIndirect(0);
  gpu::memoryBarrier();
}

GpuTask Injector::retire(LightField& field, Pacing pacing) {
  const std::optional<std::vector<LightVoxelsPtr>> held = std::exchange(field.injectedVoxels, std::nullopt);
  if (!held) {
    co_await fillChunked(field.injected.buffer);
    co_await fillChunked(field.lobeCounts);
  }
  double queued = 0.0;
  for (const LightVoxelsPtr& light : held.value_or(std::vector<LightVoxelsPtr>())) {
    if (queued > 0.0 && queued + unitsOf(*light) > pacing.unitsFor(Stage::kInject)) {
      co_yield submitted(Stage::kInject, queued);
      queued = 0.0;
    }
    params_.update(0, gpu::bytesOfValue(whereOf(field, *light)));
    dispatch(field, *light, {.retire = true});
    queued += unitsOf(*light);
  }
  co_yield submitted(Stage::kInject, queued);
  field.injectedVoxels.emplace();
}

GpuTask Injector::add(LightField& field, const std::vector<EmittingLight>& lights,
                      const std::vector<LightVoxelsPtr>& voxels, const Palette& palette, Pacing pacing) {
  field.resetCounters();
  field.injectedVoxels.reset();
  const bool only = lights.size() == 1 && voxels[0]->source.method.injection == Injection::kCount;
  double queued = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (queued > 0.0 && queued + unitsOf(*voxels[i]) > pacing.unitsFor(Stage::kInject)) {
      co_yield submitted(Stage::kInject, queued);
      queued = 0.0;
    }
    voxels[i]->group = lights[i].group;
    params_.update(0, gpu::bytesOfValue(paramsOf(field, lights[i], *voxels[i], palette.weights[i])));
    dispatch(field, *voxels[i], {.add = true, .divide = only});
    queued += unitsOf(*voxels[i]);
  }
  for (const LightVoxelsPtr& light : voxels) {
    if (only || light->source.method.injection != Injection::kCount) continue;
    if (queued > 0.0 && queued + unitsOf(*light) > pacing.unitsFor(Stage::kInject)) {
      co_yield submitted(Stage::kInject, queued);
      queued = 0.0;
    }
    params_.update(0, gpu::bytesOfValue(whereOf(field, *light)));
    dispatch(field, *light, {.divide = true});
    queued += unitsOf(*light);
  }
  co_yield submitted(Stage::kInject, queued);
  field.injectedVoxels = voxels;
}

GpuTask Injector::show(LightField& field, const std::vector<EmittingLight>& lights,
                       const std::vector<LightVoxelsPtr>& voxels, const Palette& palette, Pacing pacing) {
  field.makeInjected();
  co_await fillChunked(field.injected.buffer);
  double queued = 0.0;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    const VplTree& tree = *voxels[i]->tree;
    if (tree.entryCount == 0) continue;
    layout::InjectParams params = paramsOf(field, lights[i], *voxels[i], palette.weights[i]);
    params.weight /= float(voxels[i]->areaScale);  // VPLs have areas, not shares of one
    const CellBox cells = placeVpls(*voxels[i], field.inner(), params);
    if (cells.empty()) continue;
    params_.update(0, gpu::bytesOfValue(params));
    params_.bindUniform(layout::kParams);
    tree.nodes.bindStorage(layout::kTreeNodes);
    tree.entries.bindStorage(layout::kTreeEntries);
    field.injected.buffer.bindStorage(layout::kFieldOut);
    vplPrograms_.get({.channels = field.channels, .textured = voxels[i]->momentsPerCell > 1})
        .dispatch(groupsFor(cells));
    gpu::memoryBarrier();
    queued += unitsOf(*voxels[i]);
    if (queued < pacing.unitsFor(Stage::kInject)) continue;
    co_yield submitted(Stage::kInject, queued);
    queued = 0.0;
  }
  co_yield submitted(Stage::kInject, queued);
}

}  // namespace lpv
