#include "key_light.h"

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <glm/gtx/quaternion.hpp>
#include <memory>
#include <string>

#include "scene/raycast.h"

namespace lpv::cli {

namespace {

constexpr double kOffset = 0.4;  ///< from the camera, of its distance to what it looks at
constexpr double kSide = 0.3;    ///< of the square, the same
constexpr double kClear = 0.6;   ///< of the free way to where it would be

MeshPtr square() {
  Mesh mesh;
  mesh.positions = {{-0.5F, -0.5F, 0.0F}, {0.5F, -0.5F, 0.0F}, {0.5F, 0.5F, 0.0F}, {-0.5F, 0.5F, 0.0F}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  (void)finishMesh(mesh);  // it is one
  return std::make_shared<const Mesh>(std::move(mesh));
}

std::string freeName(const Scene& scene) {
  std::string name = "key";
  for (int i = 1; scene.surfaces.contains(name); ++i) name = "key." + std::to_string(i);
  return name;
}

}  // namespace

Scene sceneOf(const ImportedScene& file) {
  Scene out;
  for (const Surface& surface : file.surfaces) out.surfaces[surface.name] = std::make_shared<const Surface>(surface);
  return out;
}

Light keyLight(const Scene& scene, const Camera& camera) {
  const glm::dvec3 ahead = camera.target - camera.eye;
  const double distance = glm::length(ahead);
  const glm::dvec3 left = glm::normalize(glm::cross(camera.up, ahead)), up = glm::normalize(glm::cross(ahead, left));
  const glm::dvec3 beside = glm::normalize(left + 0.8 * up);
  double away = kOffset * distance;
  if (const auto hit = raycast(scene, camera.eye, beside)) away = std::min(away, kClear * hit->distance);
  const double side = std::min(kSide * distance, away);
  Light light;
  light.name = freeName(scene);
  light.mesh = square();
  light.transform.translation = camera.eye + away * beside;
  const glm::dvec3 way = camera.target - light.transform.translation;
  light.transform.rotation = glm::rotation(glm::dvec3(0, 0, 1), glm::normalize(way));
  light.transform.scale = glm::dvec3(side);
  light.radiance = glm::dvec3(glm::pi<double>() * glm::dot(way, way) / (side * side));
  return light;
}

}  // namespace lpv::cli
