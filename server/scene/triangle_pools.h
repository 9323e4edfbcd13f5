#pragma once
// Small triangles in pools, for each of which one patch stands (MATHS.md 3d.4).

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace lpv {

struct PooledTriangle {
  glm::vec3 middle{0.0F};  ///< metres
  glm::vec3 normal{0.0F};  ///< unit
  double area = 0.0;       ///< m^2
};

struct TrianglePools {
  std::vector<std::uint32_t> poolOf;   ///< by triangle
  std::vector<std::uint32_t> central;  ///< by pool, the triangle nearest to its mean
};

/// In so many pools at the most, fewer only where triangles are the same, whose triangles are close to each other and
/// face alike: the pool with the largest sum of area times the squared distance from its mean is halved, along the axis
/// along which it is widest, until there are as many. `turned`: metres, as how far apart normals count that differ by
/// 1.
TrianglePools poolsOf(std::span<const PooledTriangle> triangles, std::size_t count, double turned);

}  // namespace lpv
