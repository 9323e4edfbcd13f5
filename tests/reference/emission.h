#pragma once
// What a part of a triangle emits, integrated over its area: the truth of FLUX (MATHS.md 2).
//
// Radiance is radiance x the bilinear level-0 texture, repeated; direction is the unit direction of each point
// (Emitter::directionAt). A lobe of 2 bands is linear in (1, d): L00 = c0 Int C dA, L1 = c1 Int C d dA.
//
// The texture's integral is exact: the part is cut at the lines through texel centres, between which C is a polynomial
// of degree 2 in the barycentric coordinates. Directions are integrated on the same pieces, subdivided until rules of
// degree 4 and 8, or 8 and 12, agree to 1e-11 of the triangle: right to 1e-13 of it where directions vary by up to 170
// degrees, to 1e-8 at 179.999 and around points where they cancel. The work grows with the texels that the part covers.

#include <array>
#include <glm/glm.hpp>

#include "reference/emitter.h"
#include "reference/polygon.h"

namespace lpv::reference {

/// Int C dA over a part of the triangle, W/sr.
glm::dvec3 radianceIntegral(const Emitter& emitter, const Polygon& part);

/// Where a part emits from: integrals over its area of brightness (red + green + blue), brightness x place and
/// brightness x place place^T, world.
struct Glow {
  double amount = 0.0;
  glm::dvec3 first{0.0};
  glm::dmat3 second{0.0};
};
Glow glowIntegral(const Emitter& emitter, const Polygon& part);

struct DirectedEmission {
  glm::dvec3 direction{0.0};  ///< Int d dA, m^2
  std::array<glm::dvec3, 3> radiance{};  ///< Int C d dA for red, green, blue, W/sr
};
DirectedEmission directedIntegral(const Emitter& emitter, const Polygon& part);

}  // namespace lpv::reference
