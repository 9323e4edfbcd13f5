#include "scene/reflected_light.h"

#include <algorithm>
#include <glm/gtx/component_wise.hpp>

#include "scene/emitter_list.h"
#include "scene/sh.h"

namespace lpv {

namespace {

constexpr double kNearPatch = 9.0;  ///< as in the shader
constexpr int kRays = 256;

/// E of unit radiance with nothing between: a triangle from near, else a disc (Wallace, Elmquist and Haines 1989).
double weightOf(const Patch& patch, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dvec3 d = glm::dvec3(patch.position) - at;
  const double r2 = glm::dot(d, d), area = double(patch.area);
  if (patch.triangle && r2 < kNearPatch * area) {
    const auto& t = *patch.triangle;
    const glm::dvec3 corners[3] = {glm::dvec3(t[0]) - at, glm::dvec3(t[1]) - at, glm::dvec3(t[2]) - at};
    return triangleIrradiance(corners, n, 1);
  }
  const double facing = std::max(-glm::dot(glm::dvec3(patch.normal), d), 0.0) * std::max(glm::dot(n, d), 0.0);
  return area * facing / std::max(r2 * (r2 + area / sh::kPi), 1e-30);
}

}  // namespace

glm::dvec3 ReflectedLight::irradiance(const glm::dvec3& at, const glm::dvec3& n,
                                      const LightVisibility* visibility) const {
  std::vector<glm::dvec3> sent(patches.size());
  glm::dvec3 sum(0.0);
  double all = 0.0;
  for (std::size_t i = 0; i < patches.size(); ++i) {
    sent[i] = weightOf(patches[i], at, n) * radiance[i];
    sum += sent[i];
    all += glm::compMax(sent[i]);
  }
  if (visibility == nullptr || !(all > 0.0)) return sum;
  glm::dvec3 tried(0.0), seen(0.0);
  double before = 0.0;
  int next = 0;
  for (std::size_t i = 0; i < patches.size() && next < kRays; ++i) {
    const double size = glm::compMax(sent[i]);
    before += size;
    int rays = 0;
    for (; next < kRays && (next + 0.5) / kRays * all < before; ++next) ++rays;
    if (rays == 0) continue;
    const glm::dvec3 colour = double(rays) / size * sent[i];
    tried += colour;
    seen += colour * visibility->seen(at, n, glm::dvec3(patches[i].position));
  }
  for (int c = 0; c < 3; ++c) sum[c] *= tried[c] > 0.0 && seen[c] < tried[c] ? seen[c] / tried[c] : 1.0;
  return sum;
}

}  // namespace lpv
