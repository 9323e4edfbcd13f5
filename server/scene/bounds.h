#pragma once

#include <glm/glm.hpp>
#include <limits>

namespace lpv {

/// An axis-aligned box; empty (min > max) until something is added.
struct Bounds {
  glm::dvec3 min{std::numeric_limits<double>::infinity()};
  glm::dvec3 max{-std::numeric_limits<double>::infinity()};

  bool operator==(const Bounds&) const = default;

  bool empty() const { return min.x > max.x || min.y > max.y || min.z > max.z; }
  void add(const glm::dvec3& p) {
    min = glm::min(min, p);
    max = glm::max(max, p);
  }
  void add(const Bounds& b) {
    if (b.empty()) return;
    add(b.min);
    add(b.max);
  }
  glm::dvec3 extent() const { return max - min; }
  glm::dvec3 centre() const { return (min + max) * 0.5; }

  /// The box around the eight transformed corners.
  Bounds transformed(const glm::dmat4& m) const {
    Bounds out;
    if (empty()) return out;
    for (int corner = 0; corner < 8; ++corner) {
      const glm::dvec3 p((corner & 1) ? max.x : min.x, (corner & 2) ? max.y : min.y, (corner & 4) ? max.z : min.z);
      out.add(glm::dvec3(m * glm::dvec4(p, 1.0)));
    }
    return out;
  }
};

}  // namespace lpv
