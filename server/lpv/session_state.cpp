#include "lpv/session_state.h"

#include <algorithm>

#include "lpv/resources/voxel_grid.h"
#include "lpv/transport/emitter_list.h"
#include "lpv/transport/light_grouping.h"
#include "scene/error_goal.h"
#include "scene/gloss.h"
#include "scene/patches.h"
#include "scene/shadowing.h"

namespace lpv {

namespace {

LightsInputs inputsOf(const Scene& scene, const Grid& grid, const std::vector<EmittingLight>& lights) {
  const LightingSettings& options = scene.options;
  LightsInputs inputs;
  for (const EmittingLight& light : lights) inputs.lights.push_back(light.emission());
  inputs.grid = grid;
  inputs.transport = options.transport;
  inputs.method = {options.injection, options.method, options.denseSamples, options.transport != Transport::kPropagate};
  const glm::ivec3& dims = scene.grid.dims;
  inputs.apart = someLookedAt(lights);
  if (options.groupsItself()) inputs.groupingGoal = groupingGoal(options, std::max({dims.x, dims.y, dims.z}));
  return inputs;
}

VoxelizeInputs sourceOf(const EmittingLight& light, const VoxelGrid& grid, const VoxelMethod& method) {
  return {light.mesh,    light.texture, grid.fromField() * light.gridFromObject, grid.dims, method,
          grid.origin(), grid.cell};
}

/// The groups that lights of the same names had.
Grouping groupingOf(const std::vector<EmittingLight>& lights, const std::vector<EmittingLight>& before,
                    Sectors sectors) {
  Grouping groups;
  groups.sectors = sectors;
  for (const EmittingLight& light : lights) {
    const auto same = [&](const EmittingLight& old) {
      return old.source != nullptr && old.source->name == light.source->name;
    };
    const auto old = std::find_if(before.begin(), before.end(), same);
    if (old == before.end()) continue;
    groups.groups.push_back(old->group);
    if (old->moved == 0.0) continue;
    groups.next.push_back(old->nextGroup);
    groups.moved = old->moved;
  }
  return groups;
}

}  // namespace

void SessionState::adopt(const Scene& scene, bool guardsAsked) {
  guarded = guarded || guardsAsked;
  const std::vector<EmittingLight> before = std::move(lights);
  const FieldGrid grid = fieldGridOf(scene, guarded);
  lights = emittingLights(scene, grid.cells, before);
  const Transport transport = scene.options.transport;
  shadowed = isShadowed(scene);
  reflectionsBlocked = lpv::reflectionsBlocked(scene);
  bounces = transport == Transport::kPropagate ? BouncePlan() : bouncePlan(scene);
  glossy = showsGloss(scene);
  looksAtLights = transport == Transport::kDirect ||
                  (transport == Transport::kGather && (shadowed || bounces.turns > 0 || lookedAtEverywhere(lights)));
  if (looksAtLights || transport == Transport::kPropagate) {
    for (EmittingLight& light : lights) light.lookedAt = 0.0;  // nothing is apart
  }
  LightsInputs inputs = inputsOf(scene, grid.cells, lights);
  if (arranged.holds(inputs)) {
    for (std::size_t i = 0; i < lights.size(); ++i) {
      lights[i].group = before[i].group;
      lights[i].nextGroup = before[i].nextGroup;
      lights[i].moved = before[i].moved;
    }
  } else {
    keepVoxels(inputs);
    LightArrangement made{choosePalette(lights), cellsAround(lights, grid.cells.dims), {}};
    Grouped grouped = groupLights(scene, grid.inner(), lights, groupingOf(lights, before, sectors));
    made.groups = std::move(grouped.names);
    sectors = grouped.sectors;
    arranged.set(std::move(inputs), std::move(made));
  }
  chooseTriangles(lights, transport, scene.options.openingRatio());
  keepMemory(grid, scene.options.transport);
}

void SessionState::keepMemory(const FieldGrid& grid, Transport transport) {
  const int groups = int(arranged.product().groups.size()), apart = someLookedAt(lights) ? groups : 0;
  const FieldInputs inputs = {grid.cells.dims, palette().channels, groups + apart, transport, grid.guard, apart};
  // Where it does not fit, first the old memory goes and then comes the new.
  if (!memory.holds(inputs))
    memory.set(inputs, std::make_unique<LightField>(grid.cells, inputs.channels, inputs.groups, transport, grid.guard,
                                                    inputs.apart));
  field().grid = grid.cells;
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
  std::vector<VoxelGrid> grids;
  std::vector<VoxelizeInputs> sources;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    grids.push_back(vpls ? voxelGridFor(lights[i]) : fieldVoxels(lights[i], dims));
    sources.push_back(sourceOf(lights[i], grids[i], inputs.method));
    voxels[i] = take([&](const LightVoxelsPtr& v) { return v->made.madeFrom(sources[i]); });
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (voxels[i] == nullptr) {
      const CellBox& box = grids[i].box;
      const int momentsPerCell = sources[i].textured() ? 3 : 1;
      voxels[i] = take([&](const LightVoxelsPtr& v) { return v->takes(box, momentsPerCell, vpls); });
      if (voxels[i] == nullptr) voxels[i] = std::make_shared<LightVoxels>(box, momentsPerCell, vpls);
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
