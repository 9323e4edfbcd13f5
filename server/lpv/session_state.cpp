#include "lpv/session_state.h"

#include <algorithm>

namespace lpv {

namespace {

bool emitAlike(const std::vector<EmittingLight>& a, const std::vector<EmittingLight>& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                    [](const EmittingLight& x, const EmittingLight& y) { return x.emitsLike(y); });
}

}  // namespace

void SessionState::adopt(const Scene& scene) {
  std::vector<EmittingLight> now = emittingLights(scene, lights);
  const LightingSettings& options = scene.options;
  const VoxelMethod wantedMethod = {options.injection, options.method, options.denseSamples,
                                    options.transport != Transport::kPropagate};
  const bool sameField = field != nullptr && field->grid == scene.grid && field->transport == options.transport;
  const bool sameMethod = method == wantedMethod;
  method = wantedMethod;
  const bool sameGrouping = ownGroups == groupsItself(options);
  ownGroups = groupsItself(options);
  if (!sameField || !sameMethod || !sameGrouping || !injected || !emitAlike(now, lights)) {
    adoptLights(scene, std::move(now));
  } else {
    for (std::size_t i = 0; i < now.size(); ++i) now[i].group = lights[i].group;
    lights = std::move(now);
  }
  const int wantedIterations = options.iterationsFor(scene.grid);
  if (!transported || iterations != wantedIterations || clampFaces != options.clampFaces ||
      k != options.openingRatio()) {
    iterations = wantedIterations;
    clampFaces = options.clampFaces;
    k = options.openingRatio();
    forgetTransported();
  }
  choosePolygons(lights, options.transport, k);
  if (blockSurfaces != scene.surfaces || !sameField) {
    blockSurfaces = scene.surfaces;
    surfaceBlocks.clear();
  }
}

void SessionState::adoptLights(const Scene& scene, std::vector<EmittingLight> now) {
  std::vector<int> previous;
  for (const EmittingLight& light : now) {
    const auto same = [&](const EmittingLight& old) {
      return old.source != nullptr && old.source->name == light.source->name;
    };
    const auto old = std::find_if(lights.begin(), lights.end(), same);
    if (old != lights.end()) previous.push_back(old->group);
  }
  lights = std::move(now);
  palette = choosePalette(lights);
  groups = groupLights(scene, lights, previous);
  keepVoxels(scene.grid.dims);
  box = cellsAround(lights, scene.grid.dims);
  injected = false;
  injectedVolume.reset();
  forgetTransported();
  const Transport transport = scene.options.transport;
  if (field != nullptr && field->grid.dims == scene.grid.dims && field->channels == palette.channels &&
      field->groups == int(groups.size()) && field->transport == transport) {
    field->grid = scene.grid;
    return;
  }
  injectedVoxels.clear();
  field.reset();  // first the old memory, then the new
  textures.reset();
  incidentVolume = {};
  field = std::make_unique<LightField>(scene.grid, palette.channels, int(groups.size()), transport);
}

void SessionState::forgetTransported() {
  transported = textured = directMade = false;
  gathered.clear();
  transportedVolume.reset();
}

/// A light whose geometry stayed keeps its voxels; one that changed makes them anew in the memory of one that is gone.
void SessionState::keepVoxels(const glm::ivec3& dims) {
  std::vector<LightVoxelsPtr> old = std::move(voxels);
  std::erase(old, nullptr);
  voxels.assign(lights.size(), nullptr);
  const auto take = [&old](const auto& wanted) {
    const auto found = std::find_if(old.begin(), old.end(), wanted);
    if (found == old.end()) return LightVoxelsPtr();
    LightVoxelsPtr taken = std::move(*found);
    old.erase(found);
    return taken;
  };
  std::vector<VoxelSource> sources;
  for (std::size_t i = 0; i < lights.size(); ++i) {
    sources.push_back({lights[i].mesh, lights[i].texture, lights[i].gridFromObject, dims, method});
    voxels[i] = take([&](const LightVoxelsPtr& v) { return v->made && v->source == sources[i]; });
  }
  for (std::size_t i = 0; i < lights.size(); ++i) {
    if (voxels[i] != nullptr) continue;
    const CellBox cells = cellsAround({lights[i]}, dims);
    const int momentsPerCell = sources[i].textured() ? 3 : 1;
    voxels[i] = take([&](const LightVoxelsPtr& v) { return v->takes(cells, momentsPerCell, method.vpls); });
    if (voxels[i] == nullptr) voxels[i] = std::make_shared<LightVoxels>(cells, momentsPerCell, method.vpls);
    voxels[i]->made = false;
    voxels[i]->source = sources[i];
  }
}

void SessionState::invalidate() {
  voxels.clear();
  injectedVoxels.clear();
  field.reset();
  textures.reset();
  resources = {};
  views.clear();
  incidentVolume = {};
  injected = false;
  injectedVolume.reset();
  forgetTransported();
}

}  // namespace lpv
