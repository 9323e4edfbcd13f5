#include "lpv/resources/light_pools.h"

#include <algorithm>
#include <bit>
#include <glm/gtx/component_wise.hpp>
#include <numeric>
#include <span>

#include "shaders/layout.h"

namespace lpv {

namespace {

static_assert(layout::kLightPointTexels == 3);

void appendPoints(const EmittingLight& light, LightPool& range, const LightPoints& points,
                  std::vector<glm::vec4>& texels) {
  for (const LightPoint& p : transformed(points, light.gridFromObject)) {
    const glm::vec3 radiance = glm::vec3(light.radiance) * p.factor;
    const float brightness = glm::compMax(radiance);
    texels.emplace_back(p.position, p.area * brightness);
    texels.emplace_back(p.direction, light.twoSided ? 2.0F : 1.0F);
    texels.emplace_back(brightness > 0.0F ? radiance / brightness : glm::vec3(0.0F), float(range.firstLight));
    range.area += p.area;
    range.power += double(p.area) * brightness;
  }
  range.points = int(points.size());
}

}  // namespace

std::vector<std::size_t> brightestFirst(std::span<const LightPool> pools) {
  std::vector<std::size_t> out(pools.size());
  std::iota(out.begin(), out.end(), std::size_t(0));
  std::ranges::stable_sort(out, [pools](std::size_t a, std::size_t b) { return pools[a].power > pools[b].power; });
  return out;
}

void LightPointCache::setTimes(std::size_t times) {
  if (times == times_) return;
  times_ = times;
  kept_.clear();
}

LightPointsPtr LightPointCache::get(const EmittingLight& light) {
  if (light.source != nullptr && light.source->points != nullptr) return light.source->points;
  Kept& kept = kept_[{light.mesh, light.texture}];
  if (kept.points == nullptr) {
    LightPoints points = lightPoints(*light.mesh, light.texture.get());
    if (times_ > 1 && points.size() > kPointsOfFewPolygons)
      points = lightPoints(*light.mesh, light.texture.get(), times_);
    kept.points = std::make_shared<const LightPoints>(std::move(points));
  }
  kept.used = true;
  return kept.points;
}

void LightPointCache::sweep() {
  std::erase_if(kept_, [](const auto& entry) { return !entry.second.used; });
  for (auto& [key, kept] : kept_) kept.used = false;
}

void LightPools::make(const std::vector<EmittingLight>& lights, LightPointCache& cache) {
  pools.clear();
  ranges.clear();
  std::vector<glm::vec4> points;
  points.reserve(texels.size() / sizeof(glm::vec4));  // as many as before, most of the time
  const auto pointsSoFar = [&] { return int(points.size()) / layout::kLightPointTexels; };
  const std::size_t count = std::min(lights.size(), kMostPools);
  for (std::size_t i = 0; i < count; ++i) {
    LightPool& pool = pools.emplace_back();
    pool.firstLight = int(i * lights.size() / count);
    pool.lightsEnd = int((i + 1) * lights.size() / count);
    pool.firstPoint = pointsSoFar();
    pool.distant = pool.firstLight < pool.lightsEnd;
    for (int l = pool.firstLight; l < pool.lightsEnd; ++l) {
      const LightPtr& source = lights[std::size_t(l)].source;
      const bool distant = source != nullptr && source->distant;
      pool.distant = pool.distant && distant;
      LightPool& one = ranges.emplace_back(
          LightPool{.firstLight = l, .lightsEnd = l + 1, .firstPoint = pointsSoFar(), .distant = distant});
      appendPoints(lights[std::size_t(l)], one, *cache.get(lights[std::size_t(l)]), points);
      pool.power += one.power;
    }
    pool.points = pointsSoFar() - pool.firstPoint;
  }
  cache.sweep();
  const std::size_t bytes = std::bit_ceil(std::max(points.size(), std::size_t(1)) * sizeof(glm::vec4));
  if (texels.size() < bytes) {
    view = {};
    texels = {};  // first the old memory, then the new
    texels = gpu::Buffer("light points", bytes, gpu::BufferUse::kDynamic, gpu::Undefined{});
    view = gpu::BufferTexture("light points", texels);
  }
  texels.update(0, gpu::bytesOf(std::span<const glm::vec4>(points)));
}

}  // namespace lpv
