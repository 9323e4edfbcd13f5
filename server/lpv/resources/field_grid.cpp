#include "lpv/resources/field_grid.h"

#include <algorithm>

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

FieldGrid fieldGridOf(const Scene& scene) {
  FieldGrid out{scene.grid, 0};
  if (scene.options.transport != Transport::kGather) return out;
  const bool guarded = std::any_of(scene.surfaces.begin(), scene.surfaces.end(), [&](const auto& named) {
    const Surface& surface = *named.second;
    return meetsBounds(surface.mesh->bounds.transformed(surface.transform.worldFromObject()), scene.grid);
  });
  if (!guarded) return out;
  out.guard = 1;
  out.cells.origin -= out.cells.cell;
  out.cells.dims += 2;
  return out;
}

}  // namespace lpv
