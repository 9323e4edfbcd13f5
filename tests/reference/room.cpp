#include "reference/room.h"

#include <cmath>
#include <memory>

#include "reference/meshes.h"

namespace lpv::reference {
namespace {

Transform place(const glm::dvec3& translation, const glm::dvec3& scale, const glm::dvec3& axis, double degrees) {
  Transform t;
  t.translation = translation;
  t.scale = scale;
  t.rotation = glm::angleAxis(glm::radians(degrees), axis);
  return t;
}

void addSurface(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform,
                const glm::dvec3& albedo) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  surface->transform = transform;
  surface->albedo = albedo;
  scene.surfaces[name] = surface;
}

}  // namespace

Scene smallRoom(int longest) {
  const glm::dvec3 x(1, 0, 0);
  const glm::dvec3 y(0, 1, 0);
  const glm::dvec3 white(0.75);
  const glm::dvec3 two(2, 2, 1);
  Scene scene;
  scene.options = LightingSettings::paper();
  scene.grid.cell = 2.25 / longest;
  scene.grid.dims = glm::ivec3(longest);
  scene.grid.origin = glm::dvec3(-1.125);
  addSurface(scene, "back", quad(), place({0, 0, -1}, two, y, 0), white);
  addSurface(scene, "floor", quad(), place({0, -1, 0}, two, x, -90), white);
  addSurface(scene, "ceiling", quad(), place({0, 1, 0}, two, x, 90), white);
  addSurface(scene, "left", quad(), place({-1, 0, 0}, two, y, 90), {0.63, 0.06, 0.05});
  addSurface(scene, "right", quad(), place({1, 0, 0}, two, y, -90), {0.14, 0.45, 0.09});
  const MeshPtr block = box(glm::dvec3(-0.5), glm::dvec3(0.5));
  addSurface(scene, "tall", block, place({-0.35, -0.4, -0.35}, {0.6, 1.2, 0.6}, y, 18), white);
  addSurface(scene, "short", block, place({0.35, -0.7, 0.3}, {0.6, 0.6, 0.6}, y, -17), white);
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = quad();
  lamp->transform = place({0, 0.97, 0}, {0.8, 0.8, 1}, x, 90);
  lamp->radiance = {17.0, 12.0, 4.0};
  scene.lights["lamp"] = lamp;
  return scene;
}

Camera roomCamera() {
  Camera camera;
  camera.eye = {0.1, 0.05, 3.6};
  camera.target = {0, 0, 0};
  camera.fovDegrees = 45;
  return camera;
}

}  // namespace lpv::reference
