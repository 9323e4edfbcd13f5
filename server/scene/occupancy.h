#pragma once

#include <glm/glm.hpp>
#include <vector>

#include "scene/bounds.h"
#include "scene/scene.h"

namespace lpv {

/// The cells of a coarse grid that triangles of surfaces and enabled lights pass through.
class Occupancy {
 public:
  /// `longest`: cells along the longest edge of the scene's bounds, which are not empty.
  Occupancy(const Scene& scene, int longest);

  const Bounds& bounds() const { return bounds_; }
  const glm::ivec3& dims() const { return dims_; }
  bool at(const glm::ivec3& c) const { return cells_[index(c)]; }

  /// Metres from `eye` along unit `direction` to the first occupied cell, or out of the grid.
  double freeDistance(const glm::dvec3& eye, const glm::dvec3& direction) const;
  /// Whether the ray meets an occupied cell at least `from` metres away.
  bool isBlocked(const glm::dvec3& eye, const glm::dvec3& direction, double from) const;
  /// Edge of a cell, metres.
  double cell() const { return cell_; }

 private:
  /// Calls `visit` with each triangle's corners in world space.
  template <typename Visit>
  static void forEachTriangle(const Scene& scene, Visit visit);

  std::size_t index(const glm::ivec3& c) const {
    return (std::size_t(c.z) * std::size_t(dims_.y) + std::size_t(c.y)) * std::size_t(dims_.x) + std::size_t(c.x);
  }
  glm::ivec3 cellOf(const glm::dvec3& world) const { return glm::ivec3(glm::floor((world - bounds_.min) / cell_)); }
  bool inside(const glm::ivec3& c) const {
    return glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, dims_));
  }
  int stepsAcross(const glm::dvec3 (&v)[3]) const;
  void fill(const glm::dvec3 (&v)[3], int steps);

  Bounds bounds_;
  double cell_ = 1.0;  ///< metres
  glm::ivec3 dims_{1};
  std::vector<bool> cells_;
};

}  // namespace lpv
