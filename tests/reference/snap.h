#pragma once
// Vertices on the 1/256-cell lattice, on which pairs are decided (MATHS.md 2).

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/grid.h"
#include "scene/mesh.h"

namespace lpv::reference {

/// Lattice units along one cell edge.
inline constexpr int kUnitsPerCell = 256;

/// A point of the lattice, in units of 1/256 cell from the grid's minimum corner.
using LatticePoint = glm::vec<3, std::int64_t, glm::defaultp>;

/// A triangle of the lattice; the order of its corners does not matter.
struct SnappedTriangle {
  std::array<LatticePoint, 3> corners{};
};

/// The nearest lattice point, halves up: floor(256 g + 1/2) per axis, g in grid space.
LatticePoint snap(const glm::dvec3& gridPoint);

/// Object space to the lattice in double: world = worldFromObject p, grid = (world - origin) / cell, then snap.
LatticePoint snap(const Grid& grid, const glm::dmat4& worldFromObject, const glm::vec3& objectPoint);

/// All triangles of a mesh, in its order.
std::vector<SnappedTriangle> snapMesh(const Grid& grid, const glm::dmat4& worldFromObject, const Mesh& mesh);

}  // namespace lpv::reference
