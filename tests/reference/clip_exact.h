#pragma once
// A second, slower opinion on pairs and fractions: the triangle is clipped to the cell in exact rational arithmetic
// and its area looked at. Shares no step with pairs.h.

#include <cstdint>
#include <glm/glm.hpp>

#include "reference/snap.h"

namespace lpv::reference {

/// Largest absolute lattice coordinate the clipper accepts (a 256-cell grid): its determinants stay below 2^127.
inline constexpr std::int64_t kMaxClippedLattice = std::int64_t(1) << 16;

/// Area of the triangle within the cell as a share of the whole triangle's, under the rules of MATHS.md 2: a triangle
/// in a face plane counts for the upper cell only (the last one on the grid's outer upper face). One without area on
/// the lattice has that share of its area which snapping puts into the cell. Exact up to the last rounding to double; 0
/// only where the area is exactly 0.
double clippedFraction(const SnappedTriangle& triangle, const glm::ivec3& cell, const glm::ivec3& dims);

}  // namespace lpv::reference
