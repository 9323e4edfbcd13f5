#include "session/delivery/self_check.h"

#include <algorithm>
#include <vector>

#include "scene/lookup.h"
#include "scene/receiver_sampler.h"

namespace lpv {

namespace {

/// Evaluations of a triangle's closed form that one check may take.
constexpr std::size_t kMostEvaluations = 4'000'000;
/// Triangles of surfaces that rays may be tested against.
constexpr std::size_t kMostCrossingTests = 20'000'000;
constexpr std::size_t kLeastReceivers = 8;

/// Irradiance as the session's frames look it up, but for shadows and reflections.
Irradiance lookUp(const Scene& scene, const Volume& volume, const Receiver& at) {
  if (volume.direct != nullptr && volume.direct->always)
    return {volume.direct->unoccluded(at.position, at.normal), true};
  return irradianceWithNearField(volume, scene.options.lookup, at.position, at.normal);
}

}  // namespace

bool canSelfCheck(const Scene& scene) {
  std::size_t triangles = 0;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled || emittedRadiance(*light) == glm::dvec3(0.0)) continue;
    if (light->texture != nullptr || !light->mesh->directions.empty()) return false;
    triangles += light->mesh->triangles.size();
  }
  return triangles > 0 && triangles <= kMostCheckedTriangles;
}

std::optional<ErrorEstimate> selfCheck(const Scene& scene, const Volume& volume, std::uint32_t seed) {
  if (!canSelfCheck(scene)) return std::nullopt;
  const AreaLights lights(scene);
  const LitSides sides(scene);
  if (!(sides.area() > 0.0)) return std::nullopt;
  const std::size_t wanted =
      std::clamp<std::size_t>(kMostEvaluations / lights.triangles(), kLeastReceivers, kCheckedReceivers);
  Random random(seed);
  LitPoints lit = litPoints(sides, lights, kMostCrossingTests, random);
  std::shuffle(lit.at.begin(), lit.at.end(), random);
  lit.at.resize(std::min(lit.at.size(), wanted / 2));

  std::vector<Receiver> everywhere;
  while (everywhere.size() < wanted - lit.at.size()) everywhere.push_back(sides.sample(random));
  const double perArea = double(everywhere.size()) / sides.area();
  const double perIrradiance = lit.at.empty() ? 0.0 : double(lit.at.size()) / lit.received;
  const auto compare = [&](const std::vector<Receiver>& receivers) {
    std::vector<Compared> out;
    for (const Receiver& at : receivers) {
      const Irradiance got = lookUp(scene, volume, at);
      if (!got.valid) continue;
      const glm::dvec3 truth = lights.irradiance(at);
      const double mean = (truth.x + truth.y + truth.z) / 3.0;
      out.push_back({got.rgb, truth, 1.0 / (perArea + perIrradiance * mean)});
    }
    return out;
  };
  return estimateError({compare(everywhere), compare(lit.at)}, seed);
}

}  // namespace lpv
