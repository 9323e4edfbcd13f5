#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "scene/scene.h"

namespace lpv {

/// What a ray meets first.
struct Hit {
  std::string object;            ///< name of the light or surface
  bool isLight = false;
  glm::dvec3 position{0.0};      ///< world, metres
  glm::dvec3 normal{0.0};        ///< unit, geometric, towards the ray's origin
  double distance = 0.0;         ///< metres, >= 0
};

/// The nearest triangle of surfaces and enabled lights along a unit direction, in double. One-sided surfaces are not
/// there from behind; a light's back is.
std::optional<Hit> raycast(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace lpv
