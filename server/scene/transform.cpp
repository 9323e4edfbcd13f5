#include "scene/transform.h"

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <string>

namespace lpv {
namespace {

constexpr double kUnitTolerance = 1e-3;   // quaternions arrive as floats from many tools
constexpr double kShearTolerance = 1e-4;  // cosine between axes of a matrix that came through floats
constexpr double kLargest = 1e9;          // metres or factor: beyond it float vertices mean nothing

bool finite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

}  // namespace

glm::dmat4 Transform::worldFromObject() const {
  return glm::translate(glm::dmat4(1.0), translation) * glm::mat4_cast(rotation) * glm::scale(glm::dmat4(1.0), scale);
}

glm::dquat rotationFromEulerDegrees(const glm::dvec3& degrees) {
  const glm::dvec3 r = glm::radians(degrees);
  return glm::angleAxis(r.x, glm::dvec3(1, 0, 0)) * glm::angleAxis(r.y, glm::dvec3(0, 1, 0)) *
         glm::angleAxis(r.z, glm::dvec3(0, 0, 1));
}

Expected<Transform> checkedTransform(const Transform& t) {
  if (!finite(t.translation) || glm::length(t.translation) > kLargest) {
    return invalid("translation", "transform.translation must be finite and within 1e9 m");
  }
  const double length = glm::length(t.rotation);
  if (!(std::abs(length - 1.0) <= kUnitTolerance)) {
    return invalid("rotation", "transform.rotation must be a unit quaternion, its length is " + std::to_string(length));
  }
  if (!finite(t.scale)) return invalid("scale", "transform.scale must be finite");
  for (int axis = 0; axis < 3; ++axis) {
    const double size = std::abs(t.scale[axis]);
    if (size < 1e-9 || size > kLargest) {
      return invalid("scale", std::string("transform.scale.") + "xyz"[axis] + " is " + std::to_string(t.scale[axis]) +
                                  ": a singular transform; allowed are magnitudes 1e-9..1e9");
    }
  }
  Transform out = t;
  out.rotation = t.rotation / length;
  return out;
}

Expected<Transform> transformFromMatrix(const glm::dmat4& m) {
  for (int column = 0; column < 4; ++column) {
    for (int row = 0; row < 4; ++row) {
      if (!std::isfinite(m[column][row])) return invalid("matrix", "transform.matrix must be finite");
    }
  }
  const glm::dvec4 last(m[0][3], m[1][3], m[2][3], m[3][3]);
  if (glm::length(last - glm::dvec4(0, 0, 0, 1)) > 1e-9) {
    return invalid("matrix", "transform.matrix must be affine: its last row is not 0 0 0 1");
  }
  Transform t;
  t.translation = glm::dvec3(m[3]);
  glm::dmat3 axes(m);
  for (int axis = 0; axis < 3; ++axis) {
    t.scale[axis] = glm::length(axes[axis]);
    if (t.scale[axis] < 1e-9) return invalid("matrix", "transform.matrix is singular: an axis has no length");
    axes[axis] /= t.scale[axis];
  }
  for (int a = 0; a < 3; ++a) {
    if (std::abs(glm::dot(axes[a], axes[(a + 1) % 3])) > kShearTolerance) {
      return invalid("matrix", "transform.matrix shears: its axes are not at right angles; bake it into the vertices");
    }
  }
  if (glm::determinant(axes) < 0.0) {
    t.scale.x = -t.scale.x;
    axes[0] = -axes[0];
  }
  t.rotation = glm::normalize(glm::quat_cast(axes));
  return checkedTransform(t);
}

}  // namespace lpv
