#include "scene/scene.h"

#include "scene/sh.h"

namespace lpv {

const std::string& sessionName(const std::string& name, const Light& light) {
  return light.placedFrom == nullptr ? name : light.placedFrom->name;
}

LightPointsPtr pointsOf(const Light& light) {
  if (light.points != nullptr) return light.points;
  return std::make_shared<const LightPoints>(lightPoints(*light.mesh, light.texture.get()));
}

glm::dvec3 emittedRadiance(const Light& light) {
  if (!light.power) return light.radiance;
  const double area = worldArea(*light.mesh, light.transform) * (light.twoSided ? 2.0 : 1.0);
  return area > 0.0 ? *light.power / (sh::kPi * area) : glm::dvec3(0.0);
}

std::array<TexturePtr, 3> texturesOf(const Surface& surface) {
  return {surface.albedoTexture, surface.normalTexture, surface.glossTexture};
}

Bounds contentBounds(const Scene& scene) {
  Bounds bounds;
  for (const auto& [name, surface] : scene.surfaces) {
    bounds.add(surface->mesh->bounds.transformed(surface->transform.worldFromObject()));
  }
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && !light->distant)
      bounds.add(light->mesh->bounds.transformed(light->transform.worldFromObject()));
  }
  return bounds;
}

}  // namespace lpv
