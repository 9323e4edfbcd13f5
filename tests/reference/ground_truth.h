#pragma once
// Closed forms for polygons of constant radiance, no grid and no occluder (MATHS.md 5).

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "reference/emitter.h"
#include "reference/field.h"

namespace lpv::reference {

/// Solid angle of the triangle with corners a, b, c seen from the origin, sr, never negative
/// (Van Oosterom & Strackee 1983).
double triangleSolidAngle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// Fluence phi and vector irradiance D (towards the light) of unit radiance.
struct Moments {
  double fluence = 0.0;
  glm::dvec3 vectorIrradiance{0.0};
};

/// A triangle's moments at x; zero where x does not see its front (counter-clockwise side).
Moments triangleMoments(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& x);

/// A triangle's irradiance of unit radiance at x on a surface with unit normal n, clipped to the horizon of n
/// (Lambert; Arvo 1995); zero where x does not see its front.
double triangleIrradiance(const std::array<glm::dvec3, 3>& corners, const glm::dvec3& x, const glm::dvec3& n);

/// The same for lights, per colour, both sides of two-sided ones.
glm::dvec3 irradianceOf(const std::vector<Emitter>& emitters, const glm::dvec3& x, const glm::dvec3& n);

/// Exact 2-band SH of incident radiance at x, per colour, directions towards the light.
std::array<Coefficients, 3> incidentSh(const std::vector<Emitter>& emitters, const glm::dvec3& x);

}  // namespace lpv::reference
