#include "scene/light_visibility.h"

#include <algorithm>
#include <cmath>

#include "shaders/layout.h"

namespace lpv {

namespace {

/// Of a light that is seen in fewer points than these, the share is too coarse; it is found with kFiner times as many.
constexpr std::size_t kFewArriving = 24, kFiner = 16;
/// Of all lights together, 54 MB; scenes with more do without.
constexpr std::size_t kMostFinerPoints = 1 << 20;

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
  std::size_t points = 0;
  for (const auto& [name, light] : scene_->lights) {
    if (!light->enabled || emittedRadiance(*light) == glm::dvec3(0.0)) continue;
    Emitter& emitter = emitters_.emplace_back();
    emitter.light = light;
    emitter.points = transformed(*pointsOf(*light), light->transform.worldFromObject());
    points += emitter.points.size();
  }
  refines_ = kFiner * points <= kMostFinerPoints;
}

const LightPoints& LightVisibility::finerPoints(const Emitter& emitter) const {
  std::call_once(emitter.once, [&emitter] {
    const Light& light = *emitter.light;
    emitter.finer =
        transformed(lightPoints(*light.mesh, light.texture.get(), kFiner), light.transform.worldFromObject());
  });
  return emitter.finer;
}

LightVisibility::Arrived LightVisibility::arrived(const glm::dvec3& from, const glm::dvec3& n, std::size_t light,
                                                  const LightPoints& points) const {
  Arrived out;
  for (const LightPoint& p : points) {
    const double weight = weightOf(p, emitters_[light].light->twoSided, from, n);
    if (!(weight > 0.0)) continue;
    const glm::dvec3 light3 = weight * glm::dvec3(p.factor);
    const glm::dvec3 to = glm::mix(from, glm::dvec3(p.position), double(layout::kShadowEnd));
    const glm::dvec3 through = haze_.transmittance(from, to) * occluders_->transmitted(from, to, int(light));
    out.all += light3;
    out.seen += light3 * through;
    ++out.sending;
    if (through != glm::dvec3(0.0)) ++out.arriving;
  }
  return out;
}

glm::dvec3 LightVisibility::share(const glm::dvec3& at, const glm::dvec3& n, std::size_t light) const {
  if (!ofLights_) return glm::dvec3(1.0);
  std::call_once(once_, [this] { prepare(); });
  const Emitter& emitter = emitters_[light];
  const glm::dvec3 from = at + offset_ * n;
  Arrived got = arrived(from, n, light, emitter.points);
  const bool hasFiner = refines_ && emitter.light->points == nullptr;  // a sky's are chosen by what they send
  if (hasFiner && got.arriving > 0 && got.arriving < std::min(kFewArriving, got.sending))
    got = arrived(from, n, light, finerPoints(emitter));
  glm::dvec3 out(1.0);
  for (int c = 0; c < 3; ++c) {
    if (got.all[c] > 0.0 && got.seen[c] < got.all[c]) out[c] = got.seen[c] / got.all[c];
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
    const double towards = emitter.light->twoSided ? std::abs(along) : along;
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
