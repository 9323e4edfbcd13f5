#pragma once
// Rays against boxes and triangles, in double.

#include <glm/glm.hpp>
#include <limits>
#include <utility>

#include "scene/bounds.h"

namespace lpv {

/// True when the ray meets the box nearer than `limit`. Slabs; a zero component of the direction divides to infinity.
inline bool meetsBox(const Bounds& box, const glm::dvec3& origin, const glm::dvec3& direction, double limit) {
  double enter = 0.0;
  double leave = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1.0 / direction[axis];
    double a = (box.min[axis] - origin[axis]) * inverse;
    double b = (box.max[axis] - origin[axis]) * inverse;
    if (a > b) std::swap(a, b);
    if (a > enter) enter = a;
    if (b < leave) leave = b;
  }
  return enter <= leave * (1.0 + 1e-12) + 1e-12;
}

/// Distance along the ray to the triangle, or infinity (Moeller & Trumbore 1997). Sets the geometric normal.
inline double meetsTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& origin,
                            const glm::dvec3& direction, glm::dvec3* normal) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0.0) return kNone;
  const glm::dvec3 from = origin - a;
  const double u = glm::dot(from, p) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return kNone;
  const glm::dvec3 q = glm::cross(from, ab);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return kNone;
  const double distance = glm::dot(ac, q) / determinant;
  if (!(distance >= 0.0)) return kNone;
  *normal = glm::cross(ab, ac);
  return distance;
}

}  // namespace lpv
