#pragma once
// What homogeneous haze scatters once towards a camera: a march along the view, at each step the solid angle of every
// triangle, cut until it is small beside its distance (MATHS.md 3g).

#include <functional>
#include <vector>

#include "reference/emitter.h"
#include "scene/bounds.h"

namespace lpv::reference {

/// Haze within a box; per metre.
struct Medium {
  Bounds box;
  double extinction = 0.0;
  double scattering = 0.0;
  double anisotropy = 0.0;  ///< g of Henyey and Greenstein 1941

  /// What light keeps from a to b: by 1,000 steps, so that it shares no formula with the product.
  double transmittance(const glm::dvec3& a, const glm::dvec3& b) const;
};

/// Whether light gets from one point to the other.
using LightGets = std::function<bool(const glm::dvec3& from, const glm::dvec3& to)>;

/// Radiance that arrives at `eye` from `direction`, a unit vector, scattered before `until` metres.
glm::dvec3 scattered(const std::vector<Emitter>& emitters, const Medium& medium, const glm::dvec3& eye,
                     const glm::dvec3& direction, double until, const LightGets& seen = nullptr);

/// Irradiance at a point with normal n, through the haze.
glm::dvec3 irradianceThrough(const std::vector<Emitter>& emitters, const Medium& medium, const glm::dvec3& at,
                             const glm::dvec3& n);

}  // namespace lpv::reference
