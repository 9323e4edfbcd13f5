#include "bench/load_meshes.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace lpv::bench {

v1::Mesh sphere(int triangles) {
  const int rings = std::max(3, int(std::lround(std::sqrt(triangles / 4.0))));
  const int sectors = 2 * rings;
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (int r = 0; r <= rings; ++r) {
    const double theta = M_PI * r / rings;
    for (int s = 0; s <= sectors; ++s) {
      const double phi = 2.0 * M_PI * s / sectors;
      for (const double v : {0.4 * std::sin(theta) * std::cos(phi), 0.4 + 0.4 * std::cos(theta),
                             -0.4 * std::sin(theta) * std::sin(phi)}) {
        positions.push_back(float(v));
      }
    }
  }
  const auto at = [sectors](int r, int s) { return std::uint32_t(r * (sectors + 1) + s); };
  for (int r = 0; r < rings; ++r) {
    for (int s = 0; s < sectors; ++s) {
      for (const std::uint32_t i : {at(r, s), at(r + 1, s), at(r + 1, s + 1)}) indices.push_back(i);
      for (const std::uint32_t i : {at(r, s), at(r + 1, s + 1), at(r, s + 1)}) indices.push_back(i);
    }
  }
  v1::Mesh mesh;
  mesh.set_positions(bytesOf(positions));
  mesh.set_indices(bytesOf(indices));
  return mesh;
}

v1::Mesh room() {
  std::vector<float> positions;
  std::vector<std::uint32_t> indices;
  for (int axis = 0; axis < 3; ++axis) {
    for (int side = 0; side < 2; ++side) {
      const auto base = std::uint32_t(positions.size() / 3);
      for (int corner = 0; corner < 4; ++corner) {
        double p[3];
        p[axis] = side;
        p[(axis + 1) % 3] = (corner == 1 || corner == 2) ? 1 : 0;
        p[(axis + 2) % 3] = corner >= 2 ? 1 : 0;
        for (const double v : {6.0 * p[0] - 3.0, 3.0 * p[1], 6.0 * p[2] - 3.0}) positions.push_back(float(v));
      }
      for (const std::uint32_t i : {0U, 1U, 2U, 0U, 2U, 3U}) indices.push_back(base + i);
    }
  }
  v1::Mesh mesh;
  mesh.set_positions(bytesOf(positions));
  mesh.set_indices(bytesOf(indices));
  return mesh;
}

}  // namespace lpv::bench
