#pragma once
// Small scenes for the renderer's own tests.

#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <utility>

#include "scene/scene.h"

namespace lpv::evaluation {

inline Transform movedTo(const glm::dvec3& translation, const glm::dvec3& rotationDegrees = glm::dvec3(0.0),
                         const glm::dvec3& scale = glm::dvec3(1.0)) {
  Transform t;
  t.translation = translation;
  t.rotation = rotationFromEulerDegrees(rotationDegrees);
  t.scale = scale;
  return t;
}

inline Light& addLight(Scene& scene, MeshPtr mesh, const Transform& transform, const glm::dvec3& radiance) {
  Light light;
  light.name = std::to_string(scene.lights.size());
  light.mesh = std::move(mesh);
  light.transform = transform;
  light.radiance = radiance;
  auto made = std::make_shared<Light>(light);
  scene.lights[light.name] = made;
  return *made;
}

inline Surface& addSurface(Scene& scene, MeshPtr mesh, const Transform& transform, const glm::dvec3& albedo) {
  Surface surface;
  surface.name = std::to_string(scene.surfaces.size());
  surface.mesh = std::move(mesh);
  surface.transform = transform;
  surface.albedo = albedo;
  auto made = std::make_shared<Surface>(surface);
  scene.surfaces[surface.name] = made;
  return *made;
}

}  // namespace lpv::evaluation
