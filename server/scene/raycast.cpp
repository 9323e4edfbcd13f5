#include "scene/raycast.h"

#include <limits>

#include "scene/intersect.h"
#include "scene/transparency.h"

namespace lpv {
namespace {

/// Whether a place of a triangle covers what lies behind, so that cameras show it.
bool isSeen(const Coverage& coverage, const Mesh& mesh, const glm::uvec3& t, const std::vector<glm::dvec3>& world,
            const glm::dvec3& at) {
  if (coverage.map == nullptr) return coverage.alpha >= kSeenAlpha;
  const glm::dvec3 ab = world[t.y] - world[t.x], ac = world[t.z] - world[t.x], from = at - world[t.x];
  const glm::dvec3 normal = glm::cross(ab, ac) / glm::dot(glm::cross(ab, ac), glm::cross(ab, ac));
  const double v = glm::dot(normal, glm::cross(from, ac)), w = glm::dot(normal, glm::cross(ab, from));
  const glm::dvec2 first(mesh.uvs[t.x]), second(mesh.uvs[t.y]), third(mesh.uvs[t.z]);
  return coverage.alpha * coverage.map->at(first + v * (second - first) + w * (third - first)) >= kSeenAlpha;
}

struct Search {
  const glm::dvec3 origin;
  const glm::dvec3 direction;
  double nearest = std::numeric_limits<double>::infinity();
  std::optional<Hit> hit;

  /// `coverage`: of a surface, null for a light.
  void meet(const std::string& name, const Mesh& mesh, const Transform& transform, const Coverage* coverage,
            bool bothSides) {
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
      if (coverage != nullptr && !isSeen(*coverage, mesh, t, world, origin + direction * distance)) continue;
      nearest = distance;
      const glm::dvec3 facing = glm::dot(normal, direction) > 0.0 ? -normal : normal;
      hit = Hit{name, coverage == nullptr, origin + direction * distance, glm::normalize(facing), distance};
    }
  }
};

}  // namespace

std::optional<Hit> raycast(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction) {
  Search search{origin, direction, std::numeric_limits<double>::infinity(), std::nullopt};
  for (const auto& [name, surface] : scene.surfaces) {
    if (!surface->visibleToCamera) continue;
    const Coverage coverage = coverageOf(*surface);
    search.meet(name, *surface->mesh, surface->transform, &coverage, surface->twoSided);
  }
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && light->visibleToCamera)
      search.meet(sessionName(name, *light), *light->mesh, light->transform, nullptr, true);
  }
  return search.hit;
}

}  // namespace lpv
