#include "lpv/resources/lights.h"

#include <algorithm>
#include <cmath>

namespace lpv {

namespace {

double radianceScale(const glm::dvec3& c) { return std::max({c.r, c.g, c.b}); }

EmittingLight emitting(const LightPtr& light, const glm::dmat4& gridFromWorld, const glm::dvec3& radiance) {
  return {light,
          light->mesh,
          gridFromWorld * light->transform.worldFromObject(),
          radiance,
          light->twoSided,
          light->transform.mirrors(),
          light->mesh->uvs.empty() ? nullptr : light->texture};
}

/// Index of the channel whose colour is that of `c` up to a factor, or -1.
int channelOf(const Palette& palette, int used, const glm::dvec3& c) {
  for (int k = 0; k < used; ++k) {
    const glm::dvec3& p = palette.radiance[std::size_t(k)];
    const double tolerance = 1e-12 * radianceScale(c) * radianceScale(p);
    if (glm::all(glm::lessThanEqual(glm::abs(c * radianceScale(p) - p * radianceScale(c)), glm::dvec3(tolerance))))
      return k;
  }
  return -1;
}

Palette redGreenBlue(const std::vector<EmittingLight>& lights) {
  Palette palette;
  palette.channels = 3;
  glm::dvec3 most(0.0);
  for (const EmittingLight& light : lights) most = glm::max(most, light.radiance);
  for (int k = 0; k < 3; ++k) palette.radiance[std::size_t(k)][k] = most[k];
  for (const EmittingLight& light : lights) {
    glm::dvec3 weight(0.0);
    for (int k = 0; k < 3; ++k) weight[k] = most[k] > 0.0 ? light.radiance[k] / most[k] : 0.0;
    palette.weights.push_back(weight);
  }
  return palette;
}

}  // namespace

bool EmittingLight::emitsLike(const EmittingLight& other) const {
  return mesh == other.mesh && gridFromObject == other.gridFromObject && radiance == other.radiance &&
         twoSided == other.twoSided && mirrored == other.mirrored && texture == other.texture &&
         (source == nullptr || other.source == nullptr || source->group == other.source->group);
}

std::vector<EmittingLight> emittingLights(const Scene& scene, const std::vector<EmittingLight>& previous) {
  const glm::dmat4 gridFromWorld = scene.grid.gridFromWorldMatrix();
  std::vector<EmittingLight> lights;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    const auto known = std::find_if(previous.begin(), previous.end(), [&](const auto& p) { return p.source == light; });
    const glm::dvec3 radiance = known != previous.end() ? known->radiance : emittedRadiance(*light);
    if (radianceScale(radiance) > 0.0) lights.push_back(emitting(light, gridFromWorld, radiance));
  }
  return lights;
}

Palette choosePalette(const std::vector<EmittingLight>& lights) {
  if (std::any_of(lights.begin(), lights.end(), [](const EmittingLight& l) { return l.texture != nullptr; }))
    return redGreenBlue(lights);
  Palette palette;
  std::vector<int> channels;
  int used = 0;
  for (const EmittingLight& light : lights) {
    int k = channelOf(palette, used, light.radiance);
    if (k < 0 && used == 2) return redGreenBlue(lights);
    if (k < 0) palette.radiance[std::size_t(k = used++)] = light.radiance;
    glm::dvec3& unit = palette.radiance[std::size_t(k)];
    if (radianceScale(light.radiance) > radianceScale(unit)) unit = light.radiance;
    channels.push_back(k);
  }
  palette.channels = std::max(used, 1);
  for (std::size_t i = 0; i < lights.size(); ++i) {
    glm::dvec3 weight(0.0);
    weight[channels[i]] = radianceScale(lights[i].radiance) / radianceScale(palette.radiance[std::size_t(channels[i])]);
    palette.weights.push_back(weight);
  }
  return palette;
}

Expected<FixedPoint> fixedPointFor(std::uint64_t lobes) {
  constexpr std::uint64_t kLimit = 2147483647;
  constexpr int kFinest = 24;   // as fine as float: more would only hold noise
  constexpr int kCoarsest = 4;  // a cell's mean over so many lobes still has the digits that are missing here
  for (int shift = kFinest; shift >= kCoarsest; --shift) {
    const std::uint64_t largestWord = (std::uint64_t(1) << shift) + 1;  // a unit vector may be rounded up
    if (lobes <= kLimit / largestWord) return FixedPoint{shift, std::ldexp(0.5, -shift)};
  }
  return exhausted("lights", "a light puts up to " + std::to_string(lobes) +
                                 " lobes into one cell, more than its accumulators hold; use a coarser mesh, fewer "
                                 "dense samples, or injection FLUX");
}

CellBox CellBox::grown(const glm::ivec3& dims, int by) const {
  if (empty()) return *this;
  return {glm::max(lower - by, glm::ivec3(0)), glm::min(upper + by, dims)};
}

CellBox cellsAround(const std::vector<EmittingLight>& lights, const glm::ivec3& dims) {
  constexpr double kSnap = 1.0 / 128.0;  // cells: snapping moves a vertex by at most half a lattice unit
  Bounds all;
  for (const EmittingLight& light : lights) {
    Bounds box = light.mesh->bounds.transformed(light.gridFromObject);
    box.min -= kSnap;
    box.max += kSnap;
    if (glm::all(glm::lessThanEqual(box.min, glm::dvec3(dims))) &&
        glm::all(glm::greaterThanEqual(box.max, glm::dvec3(0.0))))
      all.add(box);
  }
  if (all.empty()) return {};
  const glm::dvec3 last = glm::dvec3(dims) - 1.0;
  return {glm::ivec3(glm::clamp(glm::floor(all.min), glm::dvec3(0.0), last)),
          glm::ivec3(glm::clamp(glm::floor(all.max), glm::dvec3(0.0), last)) + 1};
}

}  // namespace lpv
