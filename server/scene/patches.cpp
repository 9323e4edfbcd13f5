#include "scene/patches.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>

#include "scene/grid_choice.h"
#include "scene/light_points.h"

namespace lpv {

namespace {

int sidesOf(const Surface& surface) { return surface.twoSided ? 2 : 1; }

double areaOf(const Surface& surface) { return worldArea(*surface.mesh, surface.transform) * sidesOf(surface); }

void addPatches(const Surface& surface, std::size_t ofEachSide, std::vector<Patch>& out) {
  const LightPoints points = transformed(pointsOn(*surface.mesh, surface.albedoTexture.get(), ofEachSide),
                                         surface.transform.worldFromObject());
  for (int side = 0; side < sidesOf(surface); ++side) {
    for (const LightPoint& p : points)
      out.push_back({p.position, p.area, side == 0 ? p.normal : -p.normal, glm::vec3(surface.albedo) * p.factor});
  }
}

}  // namespace

std::vector<Patch> patchesOf(const Scene& scene, std::size_t count) {
  double area = 0.0;
  for (const auto& [name, surface] : scene.surfaces) area += areaOf(*surface);
  std::vector<Patch> out;
  for (const auto& [name, surface] : scene.surfaces) {
    const double own = areaOf(*surface);
    if (!(own > 0.0) || glm::compMax(surface->albedo) <= 0.0) continue;
    const double share = own / area * double(count) / sidesOf(*surface);
    addPatches(*surface, std::max<std::size_t>(1, std::size_t(std::lround(share))), out);
  }
  return out;
}

int bouncesFor(const Scene& scene) {
  constexpr double kShareOfError = 1.0 / 3.0, kHighestAlbedo = 0.98;
  double highest = 0.0;
  for (const auto& [name, surface] : scene.surfaces) highest = std::max(highest, glm::compMax(surface->albedo));
  if (scene.options.bounces != kAutoBounces || highest <= 0.0) return highest > 0.0 ? scene.options.bounces : 0;
  const double wanted = scene.options.maxError > 0.0 ? scene.options.maxError : kWantedError;
  const double goal = kShareOfError * wanted;
  return std::clamp(int(std::ceil(std::log(goal) / std::log(std::min(highest, kHighestAlbedo)))) - 1, 1, kMaxBounces);
}

}  // namespace lpv
