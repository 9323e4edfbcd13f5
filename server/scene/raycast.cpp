#include "scene/raycast.h"

#include <limits>

namespace lpv {
namespace {

/// True when the ray meets the box nearer than `limit`. Slabs; a zero component of the direction divides to infinity.
bool meetsBox(const Bounds& box, const glm::dvec3& origin, const glm::dvec3& direction, double limit) {
  double enter = 0.0;
  double leave = limit;
  for (int axis = 0; axis < 3; ++axis) {
    const double inverse = 1.0 / direction[axis];
    double a = (box.min[axis] - origin[axis]) * inverse;
    double b = (box.max[axis] - origin[axis]) * inverse;
    if (a > b) std::swap(a, b);
    if (a > enter) enter = a;
    if (b < leave) leave = b;
  }
  return enter <= leave * (1.0 + 1e-12) + 1e-12;
}

/// Distance along the ray to the triangle, or infinity (Moeller & Trumbore 1997). Sets the geometric normal.
double meetsTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& origin,
                     const glm::dvec3& direction, glm::dvec3* normal) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const glm::dvec3 ab = b - a;
  const glm::dvec3 ac = c - a;
  const glm::dvec3 p = glm::cross(direction, ac);
  const double determinant = glm::dot(ab, p);
  if (determinant == 0.0) return kNone;
  const glm::dvec3 from = origin - a;
  const double u = glm::dot(from, p) / determinant;
  if (!(u >= 0.0 && u <= 1.0)) return kNone;
  const glm::dvec3 q = glm::cross(from, ab);
  const double v = glm::dot(direction, q) / determinant;
  if (!(v >= 0.0 && u + v <= 1.0)) return kNone;
  const double distance = glm::dot(ac, q) / determinant;
  if (!(distance >= 0.0)) return kNone;
  *normal = glm::cross(ab, ac);
  return distance;
}

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
    search.meet(name, *surface->mesh, surface->transform, false, surface->twoSided);
  }
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled) search.meet(name, *light->mesh, light->transform, true, true);
  }
  return search.hit;
}

}  // namespace lpv
