#include "lpv/resources/field_grid.h"

#include <algorithm>

#include "scene/volume.h"

namespace lpv {

namespace {

/// Whether a surface's box has points within half a cell of the bounds, inside or outside.
bool meetsBounds(const Bounds& world, const Grid& grid) {
  if (world.empty()) return false;
  const glm::dvec3 lower = grid.gridFromWorld(world.min), upper = grid.gridFromWorld(world.max);
  const glm::dvec3 dims(grid.dims);
  const bool meets =
      glm::all(glm::greaterThanEqual(upper, glm::dvec3(-0.5))) && glm::all(glm::lessThanEqual(lower, dims + 0.5));
  return meets && (glm::any(glm::lessThan(lower, glm::dvec3(0.5))) || glm::any(glm::greaterThan(upper, dims - 0.5)));
}

}  // namespace

FieldGrid fieldGridOf(const Scene& scene, bool asked) {
  if (scene.options.transport == Transport::kPropagate) return {scene.grid, 0};
  const bool read = std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [&](const auto& named) {
    const Surface& surface = *named.second;
    return meetsBounds(surface.mesh->bounds.transformed(surface.transform.worldFromObject()), scene.grid);
  });
  if (!asked && (!read || scene.options.transport != Transport::kGather)) return {scene.grid, 0};
  return {guardedGrid(scene.grid), kGuardCells};
}

}  // namespace lpv
