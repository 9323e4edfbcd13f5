#include "lpv/session_state.h"

#include <algorithm>

#include "gpu/failure.h"

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
  if (!sameGrid || !injected || !emitAlike(now, lights)) {
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
  const Expected<FixedPoint> precision = fixedPointFor(std::max<std::uint64_t>(mostLobes(now), 1));
  if (!precision.ok()) throw gpu::Failure(precision.status());
  lights = std::move(now);
  palette = choosePalette(lights);
  fixedPoint = *precision;
  box = cellsAround(lights, scene.grid.dims);
  injected = transported = textured = false;
  transportedVolume.reset();
  injectedVolume.reset();
  if (field != nullptr && field->grid.dims == scene.grid.dims && field->channels == palette.channels) {
    field->grid = scene.grid;
    return;
  }
  field.reset();  // first the old memory, then the new
  textures.reset();
  product = {};
  field = std::make_unique<LightField>(scene.grid, palette.channels);
}

void SessionState::invalidate() {
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
