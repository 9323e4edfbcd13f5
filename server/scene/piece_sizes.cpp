#include "scene/piece_sizes.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/patches.h"

namespace lpv {

namespace {

constexpr double kWidthOfDistance = 0.5;  // of a piece
constexpr double kLeastRadiance = 0.05;   // of the brightest light's, of those that count

double radianceOf(const LightInPoints& light) {
  double sum = 0.0, area = 0.0;
  for (const LightPoint& p : light.points) {
    sum += double(p.area) * double(p.factor.r + p.factor.g + p.factor.b) / 3.0;
    area += double(p.area);
  }
  return area > 0.0 ? light.brightness * sum / area : 0.0;
}

/// Corners, the middles of edges, and the middle.
struct PlacesOfTriangle {
  std::array<glm::dvec3, 7> all{};
  double radius = 0.0;

  PlacesOfTriangle(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c)
      : all{(a + b + c) / 3.0, a, b, c, 0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)} {
    for (const glm::dvec3& place : all) radius = std::max(radius, glm::distance(place, all[0]));
  }
};

/// From a triangle to what of a light faces it; `reach` where it is no nearer.
double distanceTo(const LightBall& light, const PlacesOfTriangle& places, double reach) {
  if (glm::distance(places.all[0], light.middle) > reach + light.radius + places.radius) return reach;
  double nearest = reach;
  for (const LightPoint& p : light.of.points) {
    const double half = 0.5 * std::sqrt(double(p.area));
    for (const glm::dvec3& place : places.all) {
      const glm::dvec3 d = place - glm::dvec3(p.position);
      if (!light.of.twoSided && glm::dot(d, glm::dvec3(p.direction)) <= 0.0) continue;
      nearest = std::min(nearest, std::max(glm::length(d) - half, 0.5 * half));
    }
  }
  return nearest;
}

std::vector<std::int8_t> exponentsOf(const Surface& surface, const std::vector<LightBall>& lights, double reach) {
  const glm::dmat4 worldFromObject = surface.transform.worldFromObject();
  std::vector<glm::dvec3> positions;
  positions.reserve(surface.mesh->positions.size());
  for (const glm::vec3& p : surface.mesh->positions)
    positions.emplace_back(worldFromObject * glm::dvec4(glm::dvec3(p), 1.0));
  const std::vector<glm::uvec3>& triangles = patchedTriangles(surface);
  std::vector<std::int8_t> out(triangles.size(), PieceSizes::kAny);
  bool any = false;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    const glm::uvec3& t = triangles[i];
    const PlacesOfTriangle places(positions[t.x], positions[t.y], positions[t.z]);
    double distance = reach;
    for (const LightBall& light : lights) distance = std::min(distance, distanceTo(light, places, distance));
    if (distance >= reach) continue;
    out[i] = std::int8_t(std::clamp(std::floor(std::log2(kWidthOfDistance * distance)), -60.0, 60.0));
    any = true;
  }
  return any ? out : std::vector<std::int8_t>();
}

}  // namespace

PieceSizes pieceSizesNear(const std::vector<LightInPoints>& lights, const Scene& scene, double largest) {
  double brightest = 0.0;
  for (const LightInPoints& light : lights) brightest = std::max(brightest, radianceOf(light));
  std::vector<LightBall> balls;
  for (const LightInPoints& light : lights) {
    if (!light.points.empty() && radianceOf(light) > kLeastRadiance * brightest) balls.emplace_back(light);
  }
  PieceSizes out;
  if (balls.empty()) return out;
  bool any = false;
  for (const auto& [name, surface] : scene.surfaces) {
    out.exponents.push_back(exponentsOf(*surface, balls, std::sqrt(largest) / kWidthOfDistance));
    any = any || !out.exponents.back().empty();
  }
  if (!any) out.exponents.clear();
  return out;
}

}  // namespace lpv
