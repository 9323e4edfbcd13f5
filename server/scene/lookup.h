#pragma once
// Irradiance looked up in volumes. The GLSL twin is shaders/transport/lookup.glsl.

#include <array>
#include <glm/glm.hpp>
#include <optional>

#include "scene/options.h"
#include "scene/sh.h"
#include "scene/volume.h"

namespace lpv {

/// One lookup's answer.
struct Irradiance {
  glm::dvec3 rgb{0.0};  ///< W/m^2
  bool valid = false;   ///< false more than half a cell outside the grid, where the volume has no answer
};

/// Irradiance at world position p on a surface with unit normal n: trilinear (kNearest: nearest cell), clamped to the
/// outermost cell centres within half a cell outside the grid; then kCap, or phi/4 + D.n/2 (MATHS.md 4). Layers are
/// looked up one by one and summed.
Irradiance irradianceAt(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n);

/// The coefficients that it is looked up from, of each colour, layers together. Nothing where it would be invalid.
std::optional<std::array<sh::Coefficients, 3>> incidentAt(const Volume& volume, Lookup lookup, const glm::dvec3& p);

/// The same as irradianceAt() with the near field: the lights themselves where emitters are near, blended by smoothstep
/// (MATHS.md 3c), and beyond the outermost cell centres; lights that are small beside a cell everywhere. Without
/// Volume::direct as above.
Irradiance irradianceWithNearField(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n);

/// E = max(0, phi/4 + D.n/2) of one colour.
double irradianceSh2(const sh::Coefficients& incident, const glm::dvec3& n);

/// E of one colour from the uniform cap of light about D with the same phi and |D| (MATHS.md 4), n a unit vector. Exact
/// where the light and that cap are above the horizon; finite and at least 0 for any finite coefficients, |D| > phi
/// too.
double irradianceCap(const sh::Coefficients& incident, const glm::dvec3& n);

}  // namespace lpv
