#include "scene/small_lights.h"

#include <algorithm>
#include <iterator>

#include "scene/emitter_list.h"
#include "scene/emitter_tree.h"

namespace lpv {

namespace {

bool mayBeLookedAt(const LightSize& light) { return light.constant && light.triangles <= kMostTreeTriangles; }

std::size_t costOf(const LightSize& light) {
  return light.triangles > kFewPolygons ? kPolygonsOfTree : light.triangles;
}

/// Cells across from which on nothing is looked at.
double endOfSmall(std::span<const LightSize> lights) {
  std::vector<LightSize> bySize;
  std::ranges::copy_if(lights, std::back_inserter(bySize), mayBeLookedAt);
  std::ranges::stable_sort(bySize, {}, &LightSize::cellsAcross);
  std::size_t cost = 0;
  for (const LightSize& light : bySize) {
    cost += costOf(light);
    if (cost > kMostLookedAt) return std::min(kNotSmall, light.cellsAcross);
  }
  return kNotSmall;
}

double shareOf(double cellsAcross, double end) {
  const double begin = end * (kSmallBesideACell / kNotSmall);
  const double t = end > 0.0 ? std::clamp((end - cellsAcross) / (end - begin), 0.0, 1.0) : 0.0;
  return t * t * (3.0 - 2.0 * t);
}

}  // namespace

std::vector<LightSize> lightSizes(const Scene& scene, const Grid& grid) {
  std::vector<LightSize> sizes;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled || emittedRadiance(*light) == glm::dvec3(0.0)) continue;
    const glm::dmat3 linear(light->transform.worldFromObject());
    sizes.push_back({light->mesh->evenTriangles().size(), light->texture == nullptr && light->mesh->directions.empty(),
                     glm::length(linear * light->mesh->bounds.extent()) / grid.cell});
  }
  return sizes;
}

std::vector<double> lookedAtShares(std::span<const LightSize> lights) {
  const double end = endOfSmall(lights);
  std::vector<double> shares;
  for (const LightSize& light : lights) shares.push_back(mayBeLookedAt(light) ? shareOf(light.cellsAcross, end) : 0.0);
  return shares;
}

bool areLookedAtEverywhere(std::span<const double> shares) {
  return !shares.empty() && std::ranges::all_of(shares, [](double share) { return share == 1.0; });
}

bool areCheapToLookAt(std::span<const LightSize> lights) {
  std::size_t cost = 0;
  for (const LightSize& light : lights) cost += mayBeLookedAt(light) ? costOf(light) : kMostLookedAt + 1;
  return cost <= kMostLookedAt;
}

double voxelEdge(double cellsAcross) {
  double edge = 1.0;
  for (int i = 0; i < kMostHalvings && cellsAcross < kLeastCellsAcross * edge; ++i) edge *= 0.5;
  return edge;
}

}  // namespace lpv
