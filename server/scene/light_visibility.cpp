#include "scene/light_visibility.h"

#include <algorithm>
#include <cmath>

#include "shaders/layout.h"

namespace lpv {

namespace {

/// What the receiver gets from a point as if nothing lay between.
double weightOf(const LightPoint& p, bool twoSided, const glm::dvec3& at, const glm::dvec3& n) {
  const glm::dvec3 d = glm::dvec3(p.position) - at;
  const double r2 = glm::dot(d, d) + 1e-12, along = -glm::dot(glm::dvec3(p.direction), d);
  const double towards = twoSided ? std::abs(along) : std::max(along, 0.0);
  return double(p.area) * towards * std::max(glm::dot(n, d), 0.0) / (r2 * r2);
}

}  // namespace

void LightVisibility::prepare() const {
  occluders_ = std::make_unique<const Occluders>(*scene_);
  haze_ = hazeOf(*scene_);
  offset_ = double(layout::kShadowOffset) * scene_->grid.cell;
  for (const auto& [name, surface] : scene_->surfaces) {
    const Bounds box = surface->mesh->bounds.transformed(surface->transform.worldFromObject());
    bounds_.add(box.min);
    bounds_.add(box.max);
    panes_ = panes_ || !coverageOf(*surface).isOpaque();
  }
  for (const auto& [name, light] : scene_->lights) {
    if (!light->enabled || emittedRadiance(*light) == glm::dvec3(0.0)) continue;
    const LightPointsPtr points = pointsOf(*light);
    emitters_.push_back({transformed(*points, light->transform.worldFromObject()), light->twoSided});
  }
}

glm::dvec3 LightVisibility::share(const glm::dvec3& at, const glm::dvec3& n, std::size_t light) const {
  if (!ofLights_) return glm::dvec3(1.0);
  std::call_once(once_, [this] { prepare(); });
  const Emitter& emitter = emitters_[light];
  const glm::dvec3 from = at + offset_ * n;
  glm::dvec3 all(0.0), seen(0.0);
  for (const LightPoint& p : emitter.points) {
    const double weight = weightOf(p, emitter.twoSided, from, n);
    if (!(weight > 0.0)) continue;
    const glm::dvec3 light3 = weight * glm::dvec3(p.factor);
    const glm::dvec3 to = glm::mix(from, glm::dvec3(p.position), double(layout::kShadowEnd));
    all += light3;
    seen += light3 * haze_.transmittance(from, to) * occluders_->transmitted(from, to, int(light));
  }
  glm::dvec3 out(1.0);
  for (int c = 0; c < 3; ++c) {
    if (all[c] > 0.0 && seen[c] < all[c]) out[c] = seen[c] / all[c];
  }
  return out;
}

std::vector<LightVisibility::PointSeen> LightVisibility::pointsSeen(const glm::dvec3& at, std::size_t light) const {
  std::vector<PointSeen> out;
  if (!ofLights_) return out;
  std::call_once(once_, [this] { prepare(); });
  const Emitter& emitter = emitters_[light];
  for (const LightPoint& p : emitter.points) {
    const glm::dvec3 d = glm::dvec3(p.position) - at;
    const double r = glm::length(d), along = -glm::dot(glm::dvec3(p.direction), d);
    const double towards = emitter.twoSided ? std::abs(along) : along;
    if (!(r > 0.0 && towards > 0.0)) continue;
    const glm::dvec3 to = glm::mix(at, glm::dvec3(p.position), double(layout::kShadowEnd));
    out.push_back({d / r, double(p.area) * towards / (r * r * r) * glm::dvec3(p.factor),
                   haze_.transmittance(at, to) * occluders_->transmitted(at, to, int(light))});
  }
  return out;
}

glm::dvec3 LightVisibility::seen(const glm::dvec3& at, const glm::dvec3& n, const glm::dvec3& place) const {
  std::call_once(once_, [this] { prepare(); });
  const glm::dvec3 from = at + offset_ * n;
  const glm::dvec3 to = glm::mix(from, place, double(layout::kShadowEnd));
  return haze_.transmittance(from, to) * occluders_->transmitted(from, to, kFromSurfaces);
}

std::optional<LightVisibility::Sight> LightVisibility::sight(const glm::dvec3& at, const glm::dvec3& n,
                                                             const glm::dvec3& direction) const {
  std::call_once(once_, [this] { prepare(); });
  const glm::dvec3 from = at + offset_ * n;
  const double beyond = glm::length(glm::max(glm::abs(from - bounds_.min), glm::abs(from - bounds_.max)));
  const std::optional<OccluderHit> hit = occluders_->firstHit(from, from + beyond * direction);
  if (!hit) return std::nullopt;
  const glm::dvec3 to = glm::mix(from, hit->position, double(layout::kShadowEnd));
  const glm::dvec3 throughPanes = panes_ ? occluders_->transmitted(from, to, kFromSurfaces) : glm::dvec3(1.0);
  return Sight{*hit, haze_.transmittance(from, to) * throughPanes};
}

}  // namespace lpv
