#pragma once
// Homogeneous haze that fills a session's grid, and nothing outside it (MATHS.md 3g).

#include <glm/glm.hpp>

#include "scene/bounds.h"

namespace lpv {

struct Scene;

/// Even, and grey.
struct Haze {
  Bounds box;               ///< world space
  double extinction = 0.0;  ///< per metre; 0: there is none

  bool operator==(const Haze&) const = default;

  bool any() const { return extinction > 0.0; }
  /// What light keeps from one point to another, 0..1.
  double transmittance(const glm::dvec3& from, const glm::dvec3& to) const;
};

/// None where the scene's settings ask for none.
Haze hazeOf(const Scene& scene);

}  // namespace lpv
