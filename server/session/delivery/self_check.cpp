#include "session/delivery/self_check.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include "scene/emitter_list.h"
#include "scene/lookup.h"

namespace lpv {

namespace {

/// Evaluations of a triangle's closed form that one check may take.
constexpr std::size_t kMostEvaluations = 4'000'000;
/// Points tried for each that is wanted: some are near emitters, outside the grid or dark.
constexpr int kTriesPerReceiver = 8;
/// Dimmer than this share of the brightest receiver is in the dark.
constexpr double kDark = 1e-3;

using Random = std::mt19937;

double uniform(Random& random) { return std::uniform_real_distribution<double>(0.0, 1.0)(random); }

struct Receiver {
  glm::dvec3 position{0.0};
  glm::dvec3 normal{0.0, 0.0, 1.0};
};

/// A light's triangles in world space, counter-clockwise seen from the front.
struct Polygons {
  std::vector<glm::dvec3> corners;
  glm::dvec3 radiance{0.0};
  int sides = 1;

  explicit Polygons(const Light& light) : radiance(emittedRadiance(light)), sides(light.twoSided ? 2 : 1) {
    const glm::dmat4 world = light.transform.worldFromObject();
    const bool mirrored = glm::determinant(glm::dmat3(world)) < 0.0;
    for (glm::uvec3 t : light.mesh->triangles) {
      if (mirrored) std::swap(t.y, t.z);
      for (int i = 0; i < 3; ++i)
        corners.emplace_back(world * glm::dvec4(glm::dvec3(light.mesh->positions[t[i]]), 1.0));
    }
  }

  glm::dvec3 irradiance(const Receiver& at) const {
    double e = 0.0;
    for (std::size_t i = 0; i < corners.size(); i += 3) {
      const glm::dvec3 seen[3] = {corners[i] - at.position, corners[i + 1] - at.position, corners[i + 2] - at.position};
      e += triangleIrradiance(seen, at.normal, sides);
    }
    return e * radiance;
  }
};

bool emits(const Light& light) { return light.enabled && emittedRadiance(light) != glm::dvec3(0.0); }

/// The lights that emit.
std::vector<Polygons> polygonsOf(const Scene& scene) {
  std::vector<Polygons> out;
  for (const auto& [name, light] : scene.lights) {
    if (emits(*light)) out.emplace_back(*light);
  }
  return out;
}

/// A point of a surface, all triangles of all surfaces alike by number, facing either way where it has two sides.
Receiver onSurface(const Scene& scene, Random& random) {
  auto entry = scene.surfaces.begin();
  std::advance(entry, std::size_t(uniform(random) * double(scene.surfaces.size())));
  const Surface& surface = *entry->second;
  const glm::dmat4 world = surface.transform.worldFromObject();
  const glm::uvec3 t = surface.mesh->triangles[std::size_t(uniform(random) * double(surface.mesh->triangles.size()))];
  glm::dvec3 c[3];
  for (int i = 0; i < 3; ++i) c[i] = world * glm::dvec4(glm::dvec3(surface.mesh->positions[t[i]]), 1.0);
  const double u = std::sqrt(uniform(random)), v = uniform(random);
  glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  if (glm::determinant(glm::dmat3(world)) < 0.0) normal = -normal;
  if (surface.twoSided && uniform(random) < 0.5) normal = -normal;
  return {(1.0 - u) * c[0] + u * (1.0 - v) * c[1] + u * v * c[2], normal};
}

/// A point of the walls of a room a tenth smaller than the grid on each side, facing inwards.
Receiver onWall(const Grid& grid, Random& random) {
  const int axis = int(uniform(random) * 3.0) % 3;
  const bool upper = uniform(random) < 0.5;
  glm::dvec3 g(uniform(random), uniform(random), uniform(random)), normal(0.0);
  g = 0.1 + 0.8 * g;
  g[axis] = upper ? 0.9 : 0.1;
  normal[axis] = upper ? -1.0 : 1.0;
  return {grid.worldFromGrid(g * glm::dvec3(grid.dims)), normal};
}

}  // namespace

bool canSelfCheck(const Scene& scene) {
  std::size_t triangles = 0;
  for (const auto& [name, light] : scene.lights) {
    if (!emits(*light)) continue;
    if (light->texture != nullptr || !light->mesh->directions.empty()) return false;
    triangles += light->mesh->triangles.size();
  }
  return triangles > 0 && triangles <= kMostCheckedTriangles;
}

std::optional<double> selfCheck(const Scene& scene, const Volume& volume, std::uint32_t seed) {
  if (!canSelfCheck(scene)) return std::nullopt;
  const std::vector<Polygons> lights = polygonsOf(scene);
  std::size_t triangles = 0;
  for (const Polygons& light : lights) triangles += light.corners.size() / 3;
  const int wanted =
      int(std::min<std::size_t>(kCheckedReceivers, std::max<std::size_t>(kMostEvaluations / triangles, 1)));
  Random random(seed);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> seen;  // looked up, true
  double brightest = 0.0;
  std::size_t evaluations = 0;
  for (int tries = wanted * kTriesPerReceiver; tries > 0 && int(seen.size()) < wanted; --tries) {
    Receiver at = scene.surfaces.empty() ? onWall(volume.grid, random) : onSurface(scene, random);
    const double length = glm::length(at.normal);
    if (!(length > 0.0)) continue;
    at.normal /= length;
    const bool direct = volume.direct != nullptr && volume.direct->always;
    const Irradiance got =
        (direct ? irradianceWithNearField : irradianceAt)(volume, scene.options.lookup, at.position, at.normal);
    const bool away = direct || volume.direct == nullptr || volume.direct->farFromEmitters(at.position) == 1.0;
    if (!got.valid || !away) continue;
    if (evaluations > kMostEvaluations) break;
    evaluations += triangles;
    glm::dvec3 truth(0.0);
    for (const Polygons& light : lights) truth += light.irradiance(at);
    if (glm::length(truth) < kDark * brightest) continue;
    brightest = std::max(brightest, glm::length(truth));
    seen.emplace_back(got.rgb, truth);
  }
  double apart = 0.0, whole = 0.0;
  for (const auto& [got, truth] : seen) {
    apart += glm::dot(got - truth, got - truth);
    whole += glm::dot(truth, truth);
  }
  if (whole == 0.0) return std::nullopt;
  return std::sqrt(apart / whole);
}

}  // namespace lpv
