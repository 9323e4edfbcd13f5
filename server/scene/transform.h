#pragma once

#include <glm/glm.hpp>
#include <glm/gtc/quaternion.hpp>

#include "base/status.h"

namespace lpv {

/// worldFromObject: scale, then rotation, then translation. Negative scales mirror; shear cannot be expressed.
struct Transform {
  glm::dvec3 translation{0.0};                 ///< metres
  glm::dquat rotation{1.0, 0.0, 0.0, 0.0};     ///< unit quaternion (w, x, y, z)
  glm::dvec3 scale{1.0};                       ///< factor along each object axis, none zero

  bool operator==(const Transform&) const = default;

  glm::dmat4 worldFromObject() const;
  /// True when the transform turns the mesh inside out (odd number of negative scales).
  bool mirrors() const { return scale.x * scale.y * scale.z < 0.0; }
};

/// Rotation from intrinsic X, then Y, then Z angles in degrees (the command line's convention).
glm::dquat rotationFromEulerDegrees(const glm::dvec3& degrees);

/// INVALID_ARGUMENT unless all finite, the quaternion of length 1 +- 1e-3 (it is renormalised), no scale zero.
Expected<Transform> checkedTransform(const Transform& t);

/// Decomposes an affine matrix into the three fields. INVALID_ARGUMENT for a singular matrix, shear, or a
/// projective last row.
Expected<Transform> transformFromMatrix(const glm::dmat4& worldFromObject);

}  // namespace lpv
