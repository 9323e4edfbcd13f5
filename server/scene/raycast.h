#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <string>

#include "scene/scene.h"

namespace lpv {

/// First intersection of a ray with the scene.
struct Hit {
  std::string object;            ///< name of the light or surface
  bool isLight = false;
  glm::dvec3 position{0.0};      ///< world, metres
  glm::dvec3 normal{0.0};        ///< unit, geometric, towards the ray's origin
  double distance = 0.0;         ///< metres, >= 0
};

/// Intersects a ray with the surfaces and enabled lights, in double; `direction` is a unit vector. One-sided surfaces
/// cannot be hit from behind; lights can.
std::optional<Hit> raycast(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction);

}  // namespace lpv
