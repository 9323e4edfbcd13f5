#include "reference/clip_exact.h"

#include <array>
#include <stdexcept>
#include <vector>

#include "reference/int128.h"

namespace lpv::reference {
namespace {

/// A rational point (x, y, z, b1, b2) / w, w > 0, in lowest terms: relative to the cell's minimum corner, and its
/// barycentric coordinates. Between clips the coordinates are at most 2^17 and w at most 2^35, so a product of two
/// numerators takes 2^104.
using Point = std::array<Int128, 6>;
constexpr std::size_t kWeight = 5;
using Polygon = std::vector<Point>;

Int128 magnitude(Int128 a) { return a < 0 ? -a : a; }

Int128 gcd(Int128 a, Int128 b) {
  a = magnitude(a);
  b = magnitude(b);
  while (b != 0) {
    const Int128 rest = a % b;
    a = b;
    b = rest;
  }
  return a;
}

Point lowestTerms(const Point& p) {
  Int128 divisor = 0;
  for (const Int128 v : p) divisor = gcd(v, divisor);
  if (p[kWeight] < 0) divisor = -divisor;
  Point out;
  for (std::size_t k = 0; k < p.size(); ++k) out[k] = p[k] / divisor;
  return out;
}

/// Keeps the part where sign * (coordinate - plane) >= 0 (Sutherland & Hodgman 1974).
Polygon clip(const Polygon& in, std::size_t axis, Int128 plane, int sign) {
  const auto distance = [&](const Point& p) { return sign * (p[axis] - plane * p[kWeight]); };
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const Point& p = in[i];
    const Point& q = in[(i + 1) % in.size()];
    const Int128 dp = distance(p);
    const Int128 dq = distance(q);
    if (dp >= 0) out.push_back(p);
    if ((dp > 0 && dq < 0) || (dp < 0 && dq > 0)) {
      Point cut;  // (p / pw) (dq / qw) - (q / qw) (dp / pw), made homogeneous
      for (std::size_t k = 0; k < cut.size(); ++k) cut[k] = p[k] * dq - q[k] * dp;
      out.push_back(lowestTerms(cut));
    }
  }
  return out;
}

/// Twice the area of (a, b, c) in two of their coordinates: the numerator decides the sign exactly.
long double doubleArea(const Point& a, const Point& b, const Point& c, std::size_t u, std::size_t v) {
  const Int128 wa = a[kWeight];
  const Int128 wb = b[kWeight];
  const Int128 wc = c[kWeight];
  const Int128 determinant =
      wa * (b[u] * c[v] - b[v] * c[u]) - wb * (a[u] * c[v] - a[v] * c[u]) + wc * (a[u] * b[v] - a[v] * b[u]);
  return static_cast<long double>(determinant) /
         (static_cast<long double>(wa) * static_cast<long double>(wb) * static_cast<long double>(wc));
}

long double doubleArea(const Polygon& polygon, std::size_t u, std::size_t v) {
  long double sum = 0;
  for (std::size_t i = 2; i < polygon.size(); ++i) sum += doubleArea(polygon[0], polygon[i - 1], polygon[i], u, v);
  return sum;
}

/// Projected along `axis`.
long double doubleArea(const Polygon& polygon, std::size_t axis) {
  return doubleArea(polygon, (axis + 1) % 3, (axis + 2) % 3);
}

Polygon relativeTo(const SnappedTriangle& t, const glm::ivec3& cell) {
  Polygon out;
  for (const LatticePoint& corner : t.corners) {
    Point p{0, 0, 0, out.size() == 1 ? 1 : 0, out.size() == 2 ? 1 : 0, 1};
    for (int k = 0; k < 3; ++k) {
      if (corner[k] > kMaxClippedLattice || corner[k] < -kMaxClippedLattice) {
        throw std::out_of_range("lattice coordinate beyond the clipper's range");
      }
      p[std::size_t(k)] = corner[k] - std::int64_t(cell[k]) * kUnitsPerCell;
    }
    out.push_back(p);
  }
  return out;
}

/// The whole triangle lies in the cell's upper face, which is the next cell's unless there is none.
bool ownedByNextCell(const Polygon& corners, const glm::ivec3& cell, const glm::ivec3& dims) {
  for (int k = 0; k < 3; ++k) {
    if (cell[k] + 1 == dims[k]) continue;
    bool onFace = true;
    for (const Point& p : corners) onFace = onFace && p[std::size_t(k)] == kUnitsPerCell;
    if (onFace) return true;
  }
  return false;
}

}  // namespace

double clippedFraction(const SnappedTriangle& triangle, const glm::ivec3& cell, const glm::ivec3& dims) {
  const Polygon corners = relativeTo(triangle, cell);
  std::size_t axis = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    const auto area = [&](std::size_t a) { return std::abs(doubleArea(corners, a)); };
    if (area(k) > area(axis)) axis = k;
  }
  const long double whole = doubleArea(corners, axis);
  if (ownedByNextCell(corners, cell, dims)) return 0.0;
  Polygon inside = corners;
  for (std::size_t k = 0; k < 3; ++k) inside = clip(clip(inside, k, 0, 1), k, kUnitsPerCell, -1);
  return whole == 0 ? double(doubleArea(inside, 3, 4)) : double(doubleArea(inside, axis) / whole);
}

}  // namespace lpv::reference
