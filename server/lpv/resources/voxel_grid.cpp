#include "lpv/resources/voxel_grid.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtx/component_wise.hpp>

#include "shaders/layout.h"

namespace lpv {

namespace {

/// Cells: snapping moves a vertex by at most half a lattice unit.
constexpr double kSnap = 2.0 / layout::kLatticeUnits;

/// The light's box on the lattice of cells of edge `cell`: first cells, and one past the last.
struct LatticeBox {
  glm::dvec3 lower, upper;
  glm::dvec3 size() const { return upper - lower; }
};

LatticeBox latticeBox(const Bounds& bounds, double cell) {
  return {glm::floor(bounds.min / cell - kSnap), glm::floor(bounds.max / cell + kSnap) + 1.0};
}

bool tooLarge(const LatticeBox& box) {
  const glm::dvec3 size = box.size();
  return size.x * size.y * size.z > kMostVoxels || glm::compMax(size) > kMostVoxelsAcross;
}

/// Of the diagonal of a distant light's box, which may be ten thousand cells of the field: for an eighth of the sky two
/// degrees each.
constexpr double kDistantCells = 48.0;

double edgeOfDistant(const EmittingLight& light) {
  return std::exp2(std::round(std::log2(cellsAcross(light) / kDistantCells)));
}

double edgeFor(const EmittingLight& light, const Bounds& bounds) {
  const bool distant = light.source != nullptr && light.source->distant;
  double cell = fewPolygons(light) ? 1.0 : distant ? edgeOfDistant(light) : voxelEdge(cellsAcross(light));
  while (tooLarge(latticeBox(bounds, cell))) cell *= 2.0;
  return cell;
}

}  // namespace

glm::dmat4 VoxelGrid::fromField() const {
  return glm::scale(glm::translate(glm::dmat4(1.0), -lower), glm::dvec3(1.0 / cell));
}

VoxelGrid voxelGridFor(const EmittingLight& light) {
  const Bounds bounds = light.mesh->bounds.transformed(light.gridFromObject);
  VoxelGrid grid;
  if (bounds.empty()) return grid;
  grid.cell = edgeFor(light, bounds);
  const LatticeBox box = latticeBox(bounds, grid.cell);
  grid.lower = glm::floor(box.lower / double(kVoxelAlignment)) * double(kVoxelAlignment);
  grid.box = {glm::ivec3(box.lower - grid.lower), glm::ivec3(box.upper - grid.lower)};
  grid.dims = grid.box.upper;
  return grid;
}

VoxelGrid fieldVoxels(const EmittingLight& light, const glm::ivec3& dims) {
  VoxelGrid grid;
  grid.dims = dims;
  grid.box = cellsAround({light}, dims);
  return grid;
}

}  // namespace lpv
