#include "lpv/transport/light_outline.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lpv {

Outline outlineOf(const EmittingLight& light, std::size_t mostTriangles) {
  Outline o;
  o.twoSided = light.twoSided;
  o.radiance = std::max({light.radiance.r, light.radiance.g, light.radiance.b});
  const std::size_t all = light.mesh->triangles.size(), count = std::min(all, mostTriangles);
  std::vector<glm::dvec3> corners;
  for (std::size_t i = 0; i < count; ++i) {
    const glm::uvec3& t = light.mesh->triangles[i * all / count];
    std::array<glm::dvec3, 3> p;
    for (int k = 0; k < 3; ++k)
      p[std::size_t(k)] = light.gridFromObject * glm::dvec4(glm::dvec3(light.mesh->positions[t[k]]), 1.0);
    const double share = (light.mirrored ? -0.5 : 0.5) * double(all) / double(count);
    const glm::dvec3 n = share * glm::cross(p[1] - p[0], p[2] - p[0]);
    const double area = glm::length(n);
    o.areaNormal += n;
    o.area += area;
    o.centre += area / 3.0 * (p[0] + p[1] + p[2]);
    corners.insert(corners.end(), p.begin(), p.end());
  }
  if (o.area > 0.0) o.centre /= o.area;
  for (const glm::dvec3& q : corners) o.radius = std::max(o.radius, glm::distance(q, o.centre));
  return o;
}

sh::Coefficients incidentAt(const Outline& o, const glm::dvec3& x) {
  const glm::dvec3 d = o.centre - x;
  const double distance = std::max(glm::length(d), 0.5);
  const glm::dvec3 w = d / distance;
  const double t = -glm::dot(o.areaNormal, w), spread = std::max(0.0, o.area - glm::length(o.areaNormal));
  const double facing = o.twoSided ? std::abs(t) : std::max(0.0, t);
  const double fluence = o.radiance * (facing + spread / 4.0) / std::max(distance * distance, 0.25);
  const double sine = std::min(1.0, o.radius / distance);
  const double rho = 0.5 * (1.0 + std::sqrt(1.0 - sine * sine));
  return sh::fromBands(sh::kY0 * fluence, sh::kY1 * rho * fluence * w);
}

}  // namespace lpv
