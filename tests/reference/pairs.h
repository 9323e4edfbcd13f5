#pragma once
// The exact set of (triangle, cell) pairs: integers only, brute force over every candidate cell (MATHS.md 2).
//
// A pair is an intersection of positive area. A triangle T (not in a face plane) and the open box B of a cell meet iff
// the origin is inside B - T, whose facets are normal to one of 13 axes: 3 of the box, the triangle's, 9 products of
// their edges. So strict overlap on those axes, zero ones skipped, is exact. A triangle within a plane x = i is tested
// in that plane against the upper cell, or the last one when the plane is the grid's outer upper face.
//
// A triangle without area on the lattice is the segment between those two of its corners that are farthest apart. It
// makes a pair with every cell in which a piece of it has a length, decided by comparing fractions of integers; on an
// axis along which it does not extend, a coordinate on a face belongs to the upper cell, or to the last one when the
// face is the grid's outer upper one. Where all corners are one point, that is the cell of the point by the same rule.
// The pair's share is that of the triangle's area which snapping puts on the piece (polygon.h): corners keep their
// places along the segment, and the area between two places is the triangle's between them.

#include <glm/glm.hpp>
#include <vector>

#include "reference/snap.h"

namespace lpv::reference {

/// Largest absolute lattice coordinate the oracle accepts, so that 128-bit products stay exact; beyond it the functions
/// below throw std::out_of_range.
inline constexpr std::int64_t kMaxLattice = std::int64_t(1) << 40;

/// True when the three corners lie on one line (or point).
bool isDegenerate(const SnappedTriangle& triangle);

/// The one question: do triangle and cell make a pair, in a grid of `dims` cells?
bool isPair(const SnappedTriangle& triangle, const glm::ivec3& cell, const glm::ivec3& dims);

/// All cells of the grid that make a pair with the triangle, in memory order.
std::vector<glm::ivec3> cellsOf(const SnappedTriangle& triangle, const glm::ivec3& dims);

/// One entry of the pair set.
struct Pair {
  std::size_t triangle = 0;
  glm::ivec3 cell{0};

  bool operator==(const Pair&) const = default;
};

/// The pairs of many triangles, by triangle, then by cell in memory order.
std::vector<Pair> pairsOf(const std::vector<SnappedTriangle>& triangles, const glm::ivec3& dims);

}  // namespace lpv::reference
