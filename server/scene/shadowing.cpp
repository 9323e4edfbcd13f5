#include "scene/shadowing.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <limits>
#include <vector>

#include "scene/patches.h"
#include "scene/transparency.h"

namespace lpv {

namespace {

constexpr std::size_t kMostPlanes = 64;         ///< of a mesh; more can curve, and are taken to cast shadows
constexpr std::size_t kMostVertices = 256;  ///< of a mesh that are looked at one by one; else the corners of its box
constexpr std::size_t kMostComparisons = 4'000'000;
constexpr double kLeastSwallowed = 0.01;  ///< of what surfaces exchange: a third of the error that is wanted
constexpr double kClose = 0.25;  ///< of a light's diagonal: surfaces so near send much of what they get back to it
constexpr double kTowards = 0.1;  ///< least cosine of a light's front to a surface that it shines at
constexpr double kFlat = 1e-6;  ///< of the extent of all: as far from a plane vertices may be and lie in it

constexpr double kMostUneven =
    1e-3;  ///< the same where a triangle's plane is known worse, since it is thin or far away

using Points = std::vector<glm::dvec3>;

void addPoints(const Mesh& mesh, const glm::dmat4& worldFromObject, Points& out) {
  const auto add = [&](const glm::dvec3& p) { out.emplace_back(worldFromObject * glm::dvec4(p, 1.0)); };
  if (mesh.positions.size() <= kMostVertices) {
    for (const glm::vec3& p : mesh.positions) add(p);
    return;
  }
  const glm::dvec3 ends[2] = {mesh.bounds.min, mesh.bounds.max};
  for (int i = 0; i < 8; ++i) add({ends[i & 1].x, ends[(i >> 1) & 1].y, ends[i >> 2].z});
}

/// Whether points lie on both sides of the plane of a triangle, further than `within` from it. A triangle without area
/// has no plane.
template <typename Range>
bool divides(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const Range& points, double within) {
  const glm::dvec3 cross = glm::cross(b - a, c - a);
  const double size = glm::length(cross);
  if (!(size > 0.0)) return false;
  double lowest = 0.0, highest = 0.0;
  for (const auto& p : points) {
    const double height = glm::dot(cross, glm::dvec3(p) - a) / size;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  return lowest < -within && highest > within;
}

/// How far off the plane of a triangle its mesh's vertices may be, since positions are rounded to single precision:
/// what a corner is off by grows with the distance from the triangle, the more the thinner that is.
double unevenness(const Mesh& mesh, const glm::uvec3& t) {
  const glm::dvec3 a(mesh.positions[t.x]), b(mesh.positions[t.y]), c(mesh.positions[t.z]);
  const double longest = std::max({glm::distance(a, b), glm::distance(b, c), glm::distance(c, a)});
  const double width = glm::length(glm::cross(b - a, c - a)) / longest, extent = glm::length(mesh.bounds.extent());
  const glm::vec3 farthest = glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max));
  const double rounding = glm::compMax(farthest) * double(std::numeric_limits<float>::epsilon());
  return std::clamp(rounding * (1.0 + extent / width), kFlat * extent, kMostUneven * extent);
}

bool canStandBetween(const Surface& surface, const Points& points, double within) {
  if (!canStop(surface)) return false;
  const std::vector<glm::uvec3>& triangles = surface.mesh->evenTriangles();
  if (triangles.size() > kMostPlanes) return true;
  Points corners;
  const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
  for (const glm::vec3& p : surface.mesh->positions) corners.emplace_back(worldFromObject * glm::dvec4(p, 1.0));
  return std::ranges::any_of(triangles, [&](const glm::uvec3& t) {
    return divides(corners[t.x], corners[t.y], corners[t.z], points, within);
  });
}

/// Whether a light is near to a plane and shines at it.
bool shinesClosely(const Light& light, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dmat4 worldFromObject = light.transform.worldFromObject();
  Points points;
  addPoints(*light.mesh, worldFromObject, points);
  double height = std::numeric_limits<double>::infinity(), side = 0.0;
  for (const glm::dvec3& p : points) {
    height = std::min(height, std::abs(glm::dot(p - at, n)));
    side += glm::dot(p - at, n);
  }
  const glm::dvec3 extent = light.mesh->bounds.transformed(worldFromObject).extent();
  if (height > kClose * glm::length(extent)) return false;
  if (light.twoSided || light.mesh->evenTriangles().size() > kMostPlanes) return true;
  const glm::dmat3 linear(worldFromObject);
  return std::ranges::any_of(light.mesh->evenTriangles(), [&](const glm::uvec3& t) {
    const std::vector<glm::vec3>& p = light.mesh->positions;
    const glm::dvec3 a = linear * glm::dvec3(p[t.y] - p[t.x]), b = linear * glm::dvec3(p[t.z] - p[t.x]);
    const glm::dvec3 front = (light.transform.mirrors() ? -1.0 : 1.0) * glm::cross(a, b);
    return glm::dot(front, n) * side < -kTowards * glm::length(front) * std::abs(side);
  });
}

/// Whether a light is so near to a surface of few planes that it is in the way of what comes back.
bool swallowsItsOwn(const Light& light, const Surface& surface) {
  const std::vector<glm::uvec3>& triangles = surface.mesh->evenTriangles();
  if (triangles.size() > kMostPlanes) return true;
  const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
  const auto place = [&](std::uint32_t i) {
    return glm::dvec3(worldFromObject * glm::dvec4(surface.mesh->positions[i], 1.0));
  };
  return std::ranges::any_of(triangles, [&](const glm::uvec3& t) {
    const glm::dvec3 cross = glm::cross(place(t.y) - place(t.x), place(t.z) - place(t.x));
    return glm::length(cross) > 0.0 && shinesClosely(light, place(t.x), glm::normalize(cross));
  });
}

}  // namespace

bool isConvex(const Mesh& mesh) {
  const std::vector<glm::uvec3>& triangles = mesh.evenTriangles();
  if (triangles.size() * mesh.positions.size() > kMostComparisons) return false;
  return std::ranges::none_of(triangles, [&](const glm::uvec3& t) {
    const std::vector<glm::vec3>& p = mesh.positions;
    return divides(p[t.x], p[t.y], p[t.z], p, unevenness(mesh, t));
  });
}

bool blocksItself(const Light& light) { return light.castsShadow && !isConvex(*light.mesh); }

bool shadowsPossible(const Scene& scene) {
  Points points;
  bool emits = false;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled) continue;
    emits = true;
    if (blocksItself(*light)) return true;
    addPoints(*light->mesh, light->transform.worldFromObject(), points);
  }
  if (!emits) return false;
  for (const auto& [name, surface] : scene.surfaces)
    addPoints(*surface->mesh, surface->transform.worldFromObject(), points);
  const double within = kFlat * glm::length(contentBounds(scene).extent());
  return std::ranges::any_of(scene.surfaces,
                             [&](const auto& entry) { return canStandBetween(*entry.second, points, within); });
}

bool lightsSwallow(const Scene& scene) {
  if (bouncesFor(scene) == 0) return false;
  double lights = 0.0, surfaces = 0.0;
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && light->castsShadow) lights += worldArea(*light->mesh, light->transform);
  }
  for (const auto& [name, surface] : scene.surfaces) surfaces += worldArea(*surface->mesh, surface->transform);
  if (lights > kLeastSwallowed * surfaces) return true;
  return std::ranges::any_of(scene.lights, [&scene](const auto& light) {
    if (!light.second->enabled || !light.second->castsShadow) return false;
    return std::ranges::any_of(scene.surfaces,
                               [&](const auto& surface) { return swallowsItsOwn(*light.second, *surface.second); });
  });
}

bool isShadowed(const Scene& scene) {
  if (scene.options.transport == Transport::kPropagate) return false;
  if (scene.options.haze > 0.0) return true;
  switch (scene.options.visibility) {
    case Visibility::kOn:
      return true;
    case Visibility::kOff:
      return false;
    case Visibility::kAuto:
      break;
  }
  return shadowsPossible(scene);
}

bool reflectionsBlocked(const Scene& scene) {
  const bool looks = scene.options.visibility == Visibility::kAuto && scene.options.transport != Transport::kPropagate;
  return isShadowed(scene) || (looks && lightsSwallow(scene));
}

}  // namespace lpv
