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
  const bool sameGrid = field != nullptr && field->grid == scene.grid;
  const VoxelMethod wantedMethod = {scene.options.injection, scene.options.method, scene.options.denseSamples};
  const bool sameMethod = method == wantedMethod;
  method = wantedMethod;
  if (!sameGrid || !sameMethod || !injected || !emitAlike(now, lights)) {
    adoptLights(scene, std::move(now));
  } else {
    lights = std::move(now);
  }
  const int wanted = scene.options.iterationsFor(scene.grid);
  if (!transported || iterations != wanted || clampFaces != scene.options.clampFaces) {
    iterations = wanted;
    clampFaces = scene.options.clampFaces;
    transported = textured = false;
    transportedVolume.reset();
  }
}

void SessionState::adoptLights(const Scene& scene, std::vector<EmittingLight> now) {
  lights = std::move(now);
  palette = choosePalette(lights);
  keepVoxels(scene.grid.dims);
  box = cellsAround(lights, scene.grid.dims);
  injected = transported = textured = false;
  transportedVolume.reset();
  injectedVolume.reset();
  if (field != nullptr && field->grid.dims == scene.grid.dims && field->channels == palette.channels) {
    field->grid = scene.grid;
    return;
  }
  injectedVoxels.clear();
  field.reset();  // first the old memory, then the new
  textures.reset();
  product = {};
  field = std::make_unique<LightField>(scene.grid, palette.channels);
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
    const int sets = sources[i].textured() ? 3 : 1;
    voxels[i] = take([&](const LightVoxelsPtr& v) { return v->fits(cells, sets); });
    if (voxels[i] == nullptr) voxels[i] = std::make_shared<LightVoxels>(cells, sets);
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
  product = {};
  injected = transported = textured = false;
  transportedVolume.reset();
  injectedVolume.reset();
}

}  // namespace lpv
