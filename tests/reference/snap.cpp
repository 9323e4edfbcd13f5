#include "reference/snap.h"

#include <cmath>

namespace lpv::reference {

LatticePoint snap(const glm::dvec3& gridPoint) {
  LatticePoint out{};
  for (int k = 0; k < 3; ++k) out[k] = std::int64_t(std::floor(gridPoint[k] * kUnitsPerCell + 0.5));
  return out;
}

LatticePoint snap(const Grid& grid, const glm::dmat4& worldFromObject, const glm::vec3& objectPoint) {
  const glm::dvec3 world(worldFromObject * glm::dvec4(glm::dvec3(objectPoint), 1.0));
  return snap((world - grid.origin) / grid.cell);
}

std::vector<SnappedTriangle> snapMesh(const Grid& grid, const glm::dmat4& worldFromObject, const Mesh& mesh) {
  std::vector<SnappedTriangle> out;
  out.reserve(mesh.triangles.size());
  for (const glm::uvec3& t : mesh.triangles) {
    SnappedTriangle triangle;
    for (int k = 0; k < 3; ++k) {
      triangle.corners[std::size_t(k)] = snap(grid, worldFromObject, mesh.positions[t[k]]);
    }
    out.push_back(triangle);
  }
  return out;
}

}  // namespace lpv::reference
