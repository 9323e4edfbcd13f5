#include "lpv/resources/lights.h"

#include <algorithm>
#include <glm/gtx/component_wise.hpp>

namespace lpv {

namespace {

EmittingLight emitting(const LightPtr& light, const glm::dmat4& gridFromWorld, const glm::dvec3& radiance) {
  return {light,
          light->mesh,
          gridFromWorld * light->transform.worldFromObject(),
          radiance,
          light->twoSided,
          light->transform.mirrors(),
          light->mesh->uvs.empty() ? nullptr : light->texture};
}

}  // namespace

LookedAtLight lookedAt(const EmittingLight& light) {
  LookedAtLight out = {light.emission(), light.polygons, light.tree};
  out.emission.group.clear();
  return out;
}

Emission EmittingLight::emission() const {
  const bool known = source != nullptr;
  return {mesh,
          gridFromObject,
          radiance,
          twoSided,
          mirrored,
          texture,
          known ? source->group : "",
          !known || source->castsShadow};
}

std::vector<EmittingLight> emittingLights(const Scene& scene, const Grid& grid,
                                          const std::vector<EmittingLight>& previous) {
  const glm::dmat4 gridFromWorld = grid.gridFromWorldMatrix();
  std::vector<EmittingLight> lights;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    const auto known = std::find_if(previous.begin(), previous.end(), [&](const auto& p) { return p.source == light; });
    const glm::dvec3 radiance = known != previous.end() ? known->radiance : emittedRadiance(*light);
    if (glm::compMax(radiance) > 0.0) lights.push_back(emitting(light, gridFromWorld, radiance));
  }
  const std::vector<double> shares = lookedAtShares(lightSizes(scene, grid));
  for (std::size_t i = 0; i < lights.size(); ++i) lights[i].lookedAt = shares[i];
  return lights;
}

double cellsAcross(const EmittingLight& light) {
  return glm::length(glm::dmat3(light.gridFromObject) * light.mesh->bounds.extent());
}

bool isConstant(const EmittingLight& light) { return light.texture == nullptr && light.mesh->directions.empty(); }

bool fewPolygons(const EmittingLight& light) {
  return isConstant(light) && light.mesh->evenTriangles().size() <= kFewPolygons;
}

bool lookedAtEverywhere(const std::vector<EmittingLight>& lights) {
  return !lights.empty() && std::ranges::all_of(lights, [](const auto& light) { return light.lookedAt == 1.0; });
}

bool someLookedAt(const std::vector<EmittingLight>& lights) {
  return std::ranges::any_of(lights, [](const auto& light) { return light.lookedAt > 0.0; });
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
