#include "reference/inject.h"

#include "reference/pairs.h"
#include "reference/polygon.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

void addLobe(Field& field, const glm::ivec3& cell, const glm::dvec3& amount, const glm::dvec3& direction) {
  const Coefficients d = lobe(direction);
  for (int colour = 0; colour < 3; ++colour) field.at(cell)[std::size_t(colour)] += amount[colour] * d;
}

/// A lobe is linear in its amount and its direction times amount.
Coefficients lobeOf(double amount, const glm::dvec3& amountDirection) {
  const Coefficients unit = lobe({0, 0, 1});
  return {unit.x * amount, unit.z * amountDirection.y, unit.z * amountDirection.z, unit.z * amountDirection.x};
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
      const Polygon part = partInCell(e.snapped, cell);
      const Share share = measure(part);
      FluxPair pair;
      pair.emitter = i;
      pair.cell = cell;
      pair.fraction = share.fraction;
      pair.area = share.fraction * e.area();
      pair.areaNormal = share.fraction * e.areaNormal();
      pair.areaCentroid = pair.area * e.positionAt(share.centroid);
      pair.areaRadiance = radianceIntegral(e, part);
      pair.directed = directedIntegral(e, part);
      pairs.push_back(pair);
    }
  }
  return pairs;
}

Field injectFlux(const Grid& grid, const std::vector<Emitter>& emitters) {
  Field intensity(grid.dims);
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    for (int c = 0; c < 3; ++c) {
      const glm::dvec3& directed = pair.directed.radiance[std::size_t(c)];
      Coefficients& sum = intensity.at(pair.cell)[std::size_t(c)];
      sum += lobeOf(pair.areaRadiance[c], directed);
      if (emitters[pair.emitter].twoSided) sum += lobeOf(pair.areaRadiance[c], -directed);
    }
  }
  return intensity;
}

glm::dvec3 injectedPower(const Field& intensity) {
  glm::dvec3 sum(0.0);
  for (const auto& cell : intensity.cells) sum += glm::dvec3(cell[0].x, cell[1].x, cell[2].x);
  return sum * (pi() / lobe({0, 0, 1}).x);
}

}  // namespace lpv::reference
