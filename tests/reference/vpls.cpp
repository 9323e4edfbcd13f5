#include "reference/vpls.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "reference/int128.h"
#include "reference/pairs.h"
#include "reference/polygon.h"

namespace lpv::reference {
namespace {

Int128 magnitude(Int128 a) { return a < 0 ? -a : a; }

/// Twice the area of the triangle projected along `axis`, lattice units squared, exactly.
Int128 projectedArea(const SnappedTriangle& t, int axis) {
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const LatticePoint a = t.corners[1] - t.corners[0];
  const LatticePoint b = t.corners[2] - t.corners[0];
  return Int128(a[u]) * b[v] - Int128(a[v]) * b[u];
}

/// A projected triangle with its coordinates relative to a cell's lower corner, in lattice units.
class Projection {
 public:
  Projection(const SnappedTriangle& triangle, const glm::ivec3& cell) : axis_(projectionAxis(triangle)) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < 2; ++k) {
        const int axis = (axis_ + 1 + k) % 3;
        corners_[i][k] = double(triangle.corners[i][axis] - std::int64_t(cell[axis]) * kUnitsPerCell);
      }
    }
  }

  int axis() const { return axis_; }
  glm::dvec2 at(const glm::dvec3& b) const { return b.x * corners_[0] + b.y * corners_[1] + b.z * corners_[2]; }

  /// Barycentric coordinates of a point of the plane: areas of the triangles it makes with the sides.
  glm::dvec3 barycentrics(const glm::dvec2& p) const {
    const auto area = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
    const double whole = area(corners_[1] - corners_[0], corners_[2] - corners_[0]);
    const double b1 = area(p - corners_[0], corners_[2] - corners_[0]) / whole;
    const double b2 = area(corners_[1] - corners_[0], p - corners_[0]) / whole;
    return {1.0 - b1 - b2, b1, b2};
  }

 private:
  int axis_;
  std::array<glm::dvec2, 3> corners_{};
};

double angleBetween(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b));
}

/// The parameters of n lobes along an axis.
double parameter(int i, int n) { return n == 1 ? 0.5 : double(i) / (n - 1); }

std::vector<glm::dvec3> directionsOver(const Emitter& e, const Footprint& footprint) {
  std::array<glm::dvec3, 4> d{};
  for (std::size_t i = 0; i < 4; ++i) d[i] = e.directionAt(footprint.corners[i]);
  const int nu = lobesOver(std::max(angleBetween(d[0], d[1]), angleBetween(d[2], d[3])));
  const int nv = lobesOver(std::max(angleBetween(d[0], d[2]), angleBetween(d[1], d[3])));
  std::vector<glm::dvec3> directions;
  for (int j = 0; j < nv; ++j) {
    for (int i = 0; i < nu; ++i) {
      const double u = parameter(i, nu);
      const double v = parameter(j, nv);
      const glm::dvec3 mixed = (1.0 - v) * ((1.0 - u) * d[0] + u * d[1]) + v * ((1.0 - u) * d[2] + u * d[3]);
      directions.push_back(unitOr(mixed, e.normal()));
    }
  }
  return directions;
}

}  // namespace

int projectionAxis(const SnappedTriangle& t) {
  const Int128 x = magnitude(projectedArea(t, 0));
  const Int128 y = magnitude(projectedArea(t, 1));
  const Int128 z = magnitude(projectedArea(t, 2));
  if (z >= x && z >= y) return 2;
  return y >= x ? 1 : 0;
}

Footprint footprintOf(const SnappedTriangle& triangle, const glm::ivec3& cell) {
  if (isDegenerate(triangle)) {
    const glm::dvec3 centroid = measure(partInCell(triangle, cell)).centroid;
    return {{centroid, centroid, centroid, centroid}, centroid};
  }
  const Projection projection(triangle, cell);
  const int u = (projection.axis() + 1) % 3;
  const int v = (projection.axis() + 2) % 3;
  const Polygon within = clipToSlab(clipToSlab(wholeTriangle(), triangle, u, cell[u]), triangle, v, cell[v]);
  glm::dvec2 low = projection.at(within.at(0));
  glm::dvec2 high = low;
  for (const glm::dvec3& b : within) {
    low = glm::min(low, projection.at(b));
    high = glm::max(high, projection.at(b));
  }
  return {{projection.barycentrics(low), projection.barycentrics({high.x, low.y}),
           projection.barycentrics({low.x, high.y}), projection.barycentrics(high)},
          projection.barycentrics(0.5 * (low + high))};
}

int lobesOver(double angle) { return 1 + std::max(0, int(std::ceil((angle - kAngleTolerance) / kLobeSpacing))); }

double levelOfDetail(const Emitter& e, const Footprint& footprint) {
  glm::dvec2 low = e.uvAt(footprint.corners[0]);
  glm::dvec2 high = low;
  for (const glm::dvec3& corner : footprint.corners) {
    low = glm::min(low, e.uvAt(corner));
    high = glm::max(high, e.uvAt(corner));
  }
  const MipLevel& finest = e.texture->levels[0];
  return std::log2(std::max((high.x - low.x) * finest.width, (high.y - low.y) * finest.height));
}

Vpls vplsOf(const Emitter& e, const glm::ivec3& cell) {
  Vpls vpls{e.radiance, {e.normal()}};
  if (!e.texture && !e.directions) return vpls;
  const Footprint footprint = footprintOf(e.snapped, cell);
  if (e.texture) vpls.radiance *= trilinear(*e.texture, e.uvAt(footprint.centre), levelOfDetail(e, footprint));
  if (e.directions) vpls.directions = directionsOver(e, footprint);
  return vpls;
}

}  // namespace lpv::reference
