#pragma once
// What COUNT makes of one pair where a triangle is not homogeneous (paper 3.2 and 3.3; MATHS.md 2). The paper leaves
// open what "between" and "at angular distances of the lobe" mean; this is the reading held here.
//
// The box. The triangle is projected along the dominant axis of the snapped triangle's normal n (z if |nz| >= |nx|,
// |ny|; else y if |ny| >= |nx|; else x). The box is the AABB of (projected snapped triangle) within (the square of the
// cell's column), closed. It is the same for all cells of a column, and so is all that follows. Points of the box have
// barycentric coordinates in the projected snapped triangle, negative and above 1 where they lie outside. A triangle
// without area on the lattice has no box: its four corners and its centre are the centroid of its part in the cell.
//
// Directions. At each corner of the box: Emitter::directionAt of its barycentric coordinates. Along each axis of the
// box, `angle` is the larger of the angles between the corner directions at the ends of its two sides, and
//   n = 1 + ceil((angle - kAngleTolerance) / kLobeSpacing), 1 where that angle is no larger than kAngleTolerance:
// 1 lobe for none, 2 up to 90 degrees, 3 up to 180. The lobes stand at parameters i / (n - 1), i = 0 .. n - 1, or 1/2
// for n = 1, on each axis: nu x nv lobes, each in the direction of the bilinear mix of the four corner directions,
// normalised, the triangle's normal where the mix is zero (unitOr). Each has weight 1 and is counted in N.
//
// Radiance. uv at the centre and the corners of the box by the same barycentric coordinates;
//   lambda = log2(max(extent of the corners' u x W, extent of their v x H)), clamped to [0, levels - 1],
// W x H the size of level 0; C = radiance x trilinear(centre, lambda). One C for all lobes of the pair.

#include <array>
#include <glm/glm.hpp>
#include <numbers>
#include <vector>

#include "reference/emitter.h"

namespace lpv::reference {

/// Angle between neighbouring lobes, at most, rad.
inline constexpr double kLobeSpacing = 0.5 * std::numbers::pi;
/// Angles up to this much beyond a whole number of spacings do not ask for another lobe, rad.
inline constexpr double kAngleTolerance = 1e-3;

/// Axis along which a triangle is projected: 0, 1, 2 for x, y, z.
int projectionAxis(const SnappedTriangle& triangle);

/// The box of a pair, as barycentric coordinates in the projected snapped triangle.
struct Footprint {
  std::array<glm::dvec3, 4> corners;  ///< at (u, v) = (0,0), (1,0), (0,1), (1,1) of the box
  glm::dvec3 centre;
};
Footprint footprintOf(const SnappedTriangle& triangle, const glm::ivec3& cell);

/// Lobes along an axis of the box whose largest angle is `angle`, rad.
int lobesOver(double angle);

/// The lobes that one pair adds to its cell from the triangle's front.
struct Vpls {
  glm::dvec3 radiance{0.0};            ///< C of each, W/(sr m^2)
  std::vector<glm::dvec3> directions;  ///< unit; at least one
};
Vpls vplsOf(const Emitter& emitter, const glm::ivec3& cell);

/// The level of detail of 3.3, not clamped: -infinity where all corners have one uv.
double levelOfDetail(const Emitter& emitter, const Footprint& footprint);

}  // namespace lpv::reference
