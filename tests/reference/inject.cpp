#include "reference/inject.h"

#include <array>

#include "reference/pairs.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

using Polygon = std::vector<glm::dvec3>;  // barycentric coordinates in the snapped triangle

void addLobe(Field& field, const glm::ivec3& cell, const glm::dvec3& amount, const glm::dvec3& direction) {
  const Coefficients d = lobe(direction);
  for (int colour = 0; colour < 3; ++colour) field.at(cell)[std::size_t(colour)] += amount[colour] * d;
}

/// Position of a barycentric point along one axis, lattice units, relative to `origin`: exact at the corners.
double coordinate(const SnappedTriangle& t, const glm::dvec3& b, int axis, std::int64_t origin) {
  return b.x * double(t.corners[0][axis] - origin) + b.y * double(t.corners[1][axis] - origin) +
         b.z * double(t.corners[2][axis] - origin);
}

/// The part of the polygon with sign * (coordinate - plane) >= 0.
Polygon clip(const Polygon& in, const SnappedTriangle& t, int axis, std::int64_t plane, double sign) {
  Polygon out;
  for (std::size_t i = 0; i < in.size(); ++i) {
    const glm::dvec3& p = in[i];
    const glm::dvec3& q = in[(i + 1) % in.size()];
    const double dp = sign * coordinate(t, p, axis, plane);
    const double dq = sign * coordinate(t, q, axis, plane);
    if (dp >= 0.0) out.push_back(p);
    if ((dp > 0.0 && dq < 0.0) || (dp < 0.0 && dq > 0.0)) out.push_back((p * dq - q * dp) / (dq - dp));
  }
  return out;
}

/// Share of the triangle's area and barycentric centroid of a polygon. Barycentric coordinates are affine in the
/// plane, so areas in (b.y, b.z) relate as areas in space do; the whole triangle has area 1/2 there.
struct Part {
  double fraction = 0.0;
  glm::dvec3 centroid{1.0 / 3.0};
};

Part measure(const Polygon& polygon) {
  double area = 0.0;
  glm::dvec3 moment(0.0);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const glm::dvec3 u = polygon[i - 1] - polygon[0];
    const glm::dvec3 v = polygon[i] - polygon[0];
    const double twice = u.y * v.z - u.z * v.y;
    area += twice;
    moment += twice * (polygon[0] + polygon[i - 1] + polygon[i]) / 3.0;
  }
  return area != 0.0 ? Part{area, moment / area} : Part{0.0, glm::dvec3(1.0 / 3.0)};
}

Part partInCell(const SnappedTriangle& t, const glm::ivec3& cell) {
  if (isDegenerate(t)) return {1.0, glm::dvec3(1.0 / 3.0)};
  Polygon polygon = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int axis = 0; axis < 3; ++axis) {
    const std::int64_t low = std::int64_t(cell[axis]) * kUnitsPerCell;
    polygon = clip(clip(polygon, t, axis, low, 1.0), t, axis, low + kUnitsPerCell, -1.0);
  }
  return measure(polygon);
}

}  // namespace

Counted injectCount(const Grid& grid, const std::vector<Emitter>& emitters) {
  Counted out{Field(grid.dims), std::vector<std::uint32_t>(grid.cells())};
  for (const Emitter& e : emitters) {
    const glm::dvec3 n = glm::normalize(e.areaNormal());
    for (const glm::ivec3& cell : cellsOf(e.snapped, grid.dims)) {
      addLobe(out.intensity, cell, e.radiance, n);
      if (e.twoSided) addLobe(out.intensity, cell, e.radiance, -n);
      out.lobes[grid.index(cell)] += e.twoSided ? 2 : 1;
    }
  }
  for (std::size_t i = 0; i < out.lobes.size(); ++i) {
    if (out.lobes[i] == 0) continue;
    for (Coefficients& c : out.intensity.cells[i]) c *= grid.cell * grid.cell / double(out.lobes[i]);
  }
  return out;
}

std::vector<FluxPair> fluxPairs(const Grid& grid, const std::vector<Emitter>& emitters) {
  std::vector<FluxPair> pairs;
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const Emitter& e = emitters[i];
    for (const glm::ivec3& cell : cellsOf(e.snapped, grid.dims)) {
      const Part part = partInCell(e.snapped, cell);
      FluxPair pair{i, cell, part.fraction, part.fraction * e.area(), part.fraction * e.areaNormal(), {}, {}};
      pair.areaCentroid = pair.area * (part.centroid.x * e.corners[0] + part.centroid.y * e.corners[1] +
                                       part.centroid.z * e.corners[2]);
      pair.areaRadiance = pair.area * e.radiance;
      pairs.push_back(pair);
    }
  }
  return pairs;
}

Field injectFlux(const Grid& grid, const std::vector<Emitter>& emitters) {
  Field intensity(grid.dims);
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    const glm::dvec3 n = glm::normalize(emitters[pair.emitter].areaNormal());
    addLobe(intensity, pair.cell, pair.areaRadiance, n);
    if (emitters[pair.emitter].twoSided) addLobe(intensity, pair.cell, pair.areaRadiance, -n);
  }
  return intensity;
}

glm::dvec3 injectedPower(const Field& intensity) {
  glm::dvec3 sum(0.0);
  for (const auto& cell : intensity.cells) sum += glm::dvec3(cell[0].x, cell[1].x, cell[2].x);
  return sum * (pi() / lobe({0, 0, 1}).x);
}

}  // namespace lpv::reference
