#pragma once
// What a light is from afar: enough to choose which lights share a layer, at a cost that a light's triangles do not
// decide.

#include <cstddef>
#include <glm/glm.hpp>

#include "lpv/resources/lights.h"
#include "scene/sh.h"

namespace lpv {

/// Cell units, unit of radiance its brightest channel.
struct Outline {
  glm::dvec3 centre{0.0};
  double radius = 0.0;
  glm::dvec3 areaNormal{0.0};
  double area = 0.0;
  double radiance = 0.0;
  bool twoSided = false;
};

/// Looks at up to `mostTriangles`, evenly over the mesh's list.
Outline outlineOf(const EmittingLight& light, std::size_t mostTriangles);

/// SH of incident radiance at x: a cap as wide as the outline, as much light as its area sends.
sh::Coefficients incidentAt(const Outline& outline, const glm::dvec3& x);

}  // namespace lpv
