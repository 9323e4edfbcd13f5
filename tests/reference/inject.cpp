#include "reference/inject.h"

#include "reference/pairs.h"
#include "reference/polygon.h"
#include "reference/sh.h"
#include "reference/vpls.h"

namespace lpv::reference {
namespace {

/// A lobe is linear in its amount and its direction times amount.
Coefficients lobeOf(double amount, const glm::dvec3& amountDirection) {
  const Coefficients unit = lobe({0, 0, 1});
  return {unit.x * amount, unit.z * amountDirection.y, unit.z * amountDirection.z, unit.z * amountDirection.x};
}

}  // namespace

void Counted::add(const glm::ivec3& cell, const glm::dvec3& radiance, const glm::dvec3& direction, bool twoSided) {
  const Coefficients front = lobe(direction);
  const Coefficients back = lobe(-direction);
  for (int colour = 0; colour < 3; ++colour) {
    Coefficients& sum = intensity.at(cell)[std::size_t(colour)];
    sum += radiance[colour] * front;
    if (twoSided) sum += radiance[colour] * back;
  }
  lobes[intensity.index(cell)] += twoSided ? 2 : 1;
}

void Counted::divide(double cellEdge) {
  for (std::size_t i = 0; i < lobes.size(); ++i) {
    if (lobes[i] == 0) continue;
    for (Coefficients& c : intensity.cells[i]) c *= cellEdge * cellEdge / double(lobes[i]);
  }
}

Counted injectCount(const Grid& grid, const std::vector<Emitter>& emitters) {
  Counted out(grid);
  for (const Emitter& e : emitters) {
    for (const glm::ivec3& cell : cellsOf(e.snapped, grid.dims)) {
      const Vpls vpls = vplsOf(e, cell);
      for (const glm::dvec3& direction : vpls.directions) out.add(cell, vpls.radiance, direction, e.twoSided);
    }
  }
  out.divide(grid.cell);
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
      pair.glow = glowIntegral(e, part);
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
