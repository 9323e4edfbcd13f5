#pragma once
// Parts of a triangle: convex polygons in its barycentric coordinates (MATHS.md 2, FLUX and COUNT).
//
// Parts are cut on the snapped triangle and hold for the unsnapped one, which has the same barycentric coordinates.

#include <array>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "reference/snap.h"

namespace lpv::reference {

/// Corners (b0, b1, b2), b0 + b1 + b2 = 1, in order around the polygon; empty where nothing is left.
using Polygon = std::vector<glm::dvec3>;

Polygon wholeTriangle();

/// The part where `distance(b)`, affine in b, is >= 0 (Sutherland & Hodgman 1974).
template <typename Distance>
Polygon clip(const Polygon& in, Distance distance) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3& p = in[i];
    const glm::dvec3& q = in[(i + 1) % in.size()];
    const double dp = distance(p);
    const double dq = distance(q);
    if (dp >= 0.0) out.push_back(p);
    if ((dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0)) out.push_back((p * dq - q * dp) / (dq - dp));
  }
  return out;
}

/// Position of a barycentric point along one axis, lattice units, relative to `origin`: exact at the corners.
double coordinate(const SnappedTriangle& triangle, const glm::dvec3& b, int axis, std::int64_t origin);

/// The part within the cell's slab [i, i+1] of one axis.
Polygon clipToSlab(const Polygon& in, const SnappedTriangle& triangle, int axis, int cell);

/// The part within a cell that makes a pair with the triangle: what snapping puts into the (closed) cell, whether it
/// has an area on the lattice or not.
Polygon partInCell(const SnappedTriangle& triangle, const glm::ivec3& cell);

/// Share of the triangle's area and barycentric centroid of a polygon. Barycentric coordinates are affine in the
/// plane, so areas in (b1, b2) relate as areas in space do; the whole triangle has area 1/2 there.
struct Share {
  double fraction = 0.0;
  glm::dvec3 centroid{1.0 / 3.0};
};
Share measure(const Polygon& polygon);

/// A polygon as a fan of triangles.
std::vector<std::array<glm::dvec3, 3>> fanOf(const Polygon& polygon);

/// Share of the whole triangle's area of the triangle with these barycentric corners, signed.
double fractionOf(const std::array<glm::dvec3, 3>& corners);

}  // namespace lpv::reference
