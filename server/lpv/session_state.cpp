#include "lpv/session_state.h"

#include <algorithm>

#include "lpv/transport/emitter_list.h"
#include "lpv/transport/light_grouping.h"
#include "scene/error_goal.h"

namespace lpv {

namespace {

LightsInputs inputsOf(const Scene& scene, const std::vector<EmittingLight>& lights) {
  const LightingSettings& options = scene.options;
  LightsInputs inputs;
  for (const EmittingLight& light : lights) inputs.lights.push_back(light.emission());
  inputs.grid = scene.grid;
  inputs.transport = options.transport;
  inputs.method = {options.injection, options.method, options.denseSamples, options.transport != Transport::kPropagate};
  const glm::ivec3& dims = scene.grid.dims;
  if (options.groupsItself()) inputs.groupingGoal = groupingGoal(options, std::max({dims.x, dims.y, dims.z}));
  return inputs;
}

/// The groups that lights of the same names had.
std::vector<int> groupsOf(const std::vector<EmittingLight>& lights, const std::vector<EmittingLight>& before) {
  std::vector<int> groups;
  for (const EmittingLight& light : lights) {
    const auto same = [&](const EmittingLight& old) {
      return old.source != nullptr && old.source->name == light.source->name;
    };
    const auto old = std::find_if(before.begin(), before.end(), same);
    if (old != before.end()) groups.push_back(old->group);
  }
  return groups;
}

}  // namespace

void SessionState::adopt(const Scene& scene) {
  const std::vector<EmittingLight> before = std::move(lights);
  lights = emittingLights(scene, before);
  LightsInputs inputs = inputsOf(scene, lights);
  if (arranged.holds(inputs)) {
    for (std::size_t i = 0; i < lights.size(); ++i) lights[i].group = before[i].group;
  } else {
    keepVoxels(inputs);
    LightArrangement made{choosePalette(lights), cellsAround(lights, scene.grid.dims), {}};
    Grouped grouped = groupLights(scene, lights, {groupsOf(lights, before), sectors});
    made.groups = std::move(grouped.names);
    sectors = grouped.sectors;
    arranged.set(std::move(inputs), std::move(made));
  }
  choosePolygons(lights, scene.options.transport, scene.options.openingRatio());
  keepMemory(scene.grid, scene.options.transport);
}

void SessionState::keepMemory(const Grid& grid, Transport transport) {
  const FieldInputs inputs = {grid.dims, palette().channels, int(arranged.product().groups.size()), transport};
  // Where it does not fit, first the old memory goes and then comes the new.
  if (!memory.holds(inputs))
    memory.set(inputs, std::make_unique<LightField>(grid, inputs.channels, inputs.groups, transport));
  field().grid = grid;
}

/// A light whose geometry stayed keeps its voxels; one that changed makes them anew in the memory of one that is gone.
void SessionState::keepVoxels(const LightsInputs& inputs) {
  std::vector<LightVoxelsPtr> old = std::move(voxels);
  voxels.assign(lights.size(), nullptr);
  const auto take = [&old](const auto& wanted) {
    const auto found = std::find_if(old.begin(), old.end(), wanted);
    if (found == old.end()) return LightVoxelsPtr();
    LightVoxelsPtr taken = std::move(*found);
    old.erase(found);
    return taken;
  };
  const glm::ivec3& dims = inputs.grid.dims;
  const bool vpls = inputs.method.vpls;
  std::vector<VoxelizeInputs> sources;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    sources.push_back({lights[i].mesh, lights[i].texture, lights[i].gridFromObject, dims, inputs.method});
    voxels[i] = take([&](const LightVoxelsPtr& v) { return v->made.madeFrom(sources[i]); });
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (voxels[i] == nullptr) {
      const CellBox cells = cellsAround({lights[i]}, dims);
      const int momentsPerCell = sources[i].textured() ? 3 : 1;
      voxels[i] = take([&](const LightVoxelsPtr& v) { return v->takes(cells, momentsPerCell, vpls); });
      if (voxels[i] == nullptr) voxels[i] = std::make_shared<LightVoxels>(cells, momentsPerCell, vpls);
    }
    voxels[i]->source = sources[i];
  }
}

void SessionState::invalidate() {
  resources = {};
  voxels.clear();
  arranged.forget();
  memory.forget();
  products.reset();
  views.clear();
}

}  // namespace lpv
