#pragma once

#include <glm/glm.hpp>

#include "base/status.h"
#include "scene/bounds.h"

namespace lpv {

/// A perspective camera. Right-handed: looks from `eye` towards `target`, `up` is up in the picture.
struct Camera {
  glm::dvec3 eye{0.0, 1.0, 3.0};   ///< world, metres
  glm::dvec3 target{0.0};          ///< world, metres; not equal to eye
  glm::dvec3 up{0.0, 1.0, 0.0};    ///< not parallel to the view direction
  double fovDegrees = 50.0;        ///< vertical, 1..170
  double near = 0.01;              ///< metres, > 0
  double far = 1000.0;             ///< metres, > near

  /// Sets near and far for who gives none: .01 and 1,000 m, nearer and farther where the target is: a hundredth of its
  /// distance, and a hundred times it. So a scene of millimetres and one of kilometres are seen whole.
  void setRangeByDistance();
  /// Sets up for who gives none: (0, 1, 0), or (0, 0, -1) for a view along that, straight down or up.
  void setUpByView();

  bool operator==(const Camera&) const = default;

  glm::dmat4 viewFromWorld() const;
  /// OpenGL clip space, depth -1..1.
  glm::dmat4 clipFromView(double aspect) const;
  /// Unit world direction through picture position (u, v), both 0..1, v = 0 at the top.
  glm::dvec3 rayDirection(double u, double v, double aspect) const;
};

/// INVALID_ARGUMENT naming the field unless every value is finite and in range.
Status checkCamera(const Camera& camera);

/// A view of the whole content from a corner, a little above.
Camera defaultCamera(const Bounds& content);

}  // namespace lpv
