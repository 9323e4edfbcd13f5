#include "scene/reflected_light.h"

#include <algorithm>
#include <glm/gtx/component_wise.hpp>

#include "scene/emitter_list.h"

namespace lpv {

namespace {

constexpr double kNearPatch = 9.0;  ///< as in the shader
constexpr double kSizeOfArea = 0.44;
constexpr int kRays = 256;

/// E of unit radiance with nothing between: a triangle from near, else to second order in the patch's size
/// (shaders/visibility/patches.glsl).
double weightOf(const Patch& patch, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dvec3 d = glm::dvec3(patch.position) - at;
  const double r2 = glm::dot(d, d), area = double(patch.area);
  if (patch.triangle && r2 < kNearPatch * area) {
    const auto& t = *patch.triangle;
    const glm::dvec3 corners[3] = {glm::dvec3(t[0]) - at, glm::dvec3(t[1]) - at, glm::dvec3(t[2]) - at};
    return triangleIrradiance(corners, n, 1);
  }
  const double size = kSizeOfArea * area, p = glm::dot(n, d);
  const double q = std::min(glm::dot(glm::dvec3(patch.normal), d), 0.0);
  if (!(p > 0.0) || !(r2 > 0.0)) return 0.0;
  const double across = glm::dot(n, glm::dvec3(patch.normal)) * q + 2.0 * p - 3.0 * p * q * q / r2;
  return area * -q * std::max(p + size / (r2 + size) * across, 0.0) / (r2 * (r2 + size));
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
