#include "scene/raycast.h"

#include <limits>

#include "scene/intersect.h"

namespace lpv {
namespace {

struct Search {
  const glm::dvec3 origin;
  const glm::dvec3 direction;
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<Hit> hit;

  void meet(const std::string& name, const Mesh& mesh, const Transform& transform, bool isLight, bool bothSides) {
    const glm::dmat4 worldFromObject = transform.worldFromObject();
    if (!meetsBox(mesh.bounds.transformed(worldFromObject), origin, direction, nearest)) return;
    std::vector<glm::dvec3> world;
    world.reserve(mesh.positions.size());
    for (const glm::vec3& p : mesh.positions) world.emplace_back(worldFromObject * glm::dvec4(glm::dvec3(p), 1.0));
    const double outward = transform.mirrors() ? -1.0 : 1.0;
    for (const glm::uvec3& t : mesh.triangles) {
      glm::dvec3 normal(0.0);
      const double distance = meetsTriangle(world[t.x], world[t.y], world[t.z], origin, direction, &normal);
      if (distance >= nearest) continue;
      const bool fromBehind = glm::dot(normal, direction) * outward > 0.0;
      if (fromBehind && !bothSides) continue;
      nearest = distance;
      const glm::dvec3 facing = glm::dot(normal, direction) > 0.0 ? -normal : normal;
      hit = Hit{name, isLight, origin + direction * distance, glm::normalize(facing), distance};
    }
  }
};

}  // namespace

std::optional<Hit> raycast(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  Search search{origin, direction, std::numeric_limits<double>::infinity(), std::nullopt};
  for (const auto& [name, surface] : scene.surfaces) {
    if (!surface->visibleToCamera) continue;
    search.meet(name, *surface->mesh, surface->transform, false, surface->twoSided);
  }
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && light->visibleToCamera) search.meet(name, *light->mesh, light->transform, true, true);
  }
  return search.hit;
}

}  // namespace lpv
