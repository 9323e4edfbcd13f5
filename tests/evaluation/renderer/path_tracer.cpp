#include "renderer/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace lpv::evaluation {

namespace {

constexpr double kPi = glm::pi<double>();
constexpr int kRouletteFrom = 4;          ///< bounces that every path may take
constexpr double kMostSurvival = 0.98;    ///< of a path, per bounce

/// A direction about `normal` with density cosine / pi (Malley), in the frame of Duff et al. 2017.
glm::dvec3 cosineDirection(const glm::dvec3& n, const glm::dvec2& random) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1.0 / (sign + n.z);
  const double b = n.x * n.y * a;
  const glm::dvec3 s(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x);
  const glm::dvec3 t(b, sign + n.y * n.y * a, -n.y);
  const double r = std::sqrt(random.x);
  const double phi = 2.0 * kPi * random.y;
  return glm::normalize(r * std::cos(phi) * s + r * std::sin(phi) * t + std::sqrt(1.0 - random.x) * n);
}

double powerWeight(double mine, double other) { return mine * mine / (mine * mine + other * other); }

glm::dvec3 above(const TracedScene& scene, const Receiver& receiver) {
  return receiver.position + scene.offsetAt(receiver.position) * receiver.flatNormal;
}

}  // namespace

Receiver receiverAt(const Hit& hit) {
  const double side = hit.front ? 1.0 : -1.0;
  return {hit.position, side * hit.flatNormal, side * hit.normal};
}

PathTracer::Direct PathTracer::fromLight(const Receiver& receiver, const glm::dvec2& random) const {
  Direct out;
  if (!scene_.hasLights()) return out;
  const LightSample light = scene_.sampleLight(random);
  const glm::dvec3 to = light.position - receiver.position;
  const double distance = glm::length(to);
  if (distance <= 0.0) return out;
  const glm::dvec3 direction = to / distance;
  const double cosine = glm::dot(receiver.normal, direction);
  double cosineThere = -glm::dot(light.normal, direction);
  if (light.twoSided) cosineThere = std::abs(cosineThere);
  if (cosine <= 0.0 || cosineThere <= 0.0) return out;
  const double density = light.density * distance * distance / cosineThere;  // per sr
  out.unoccluded = light.radiance * cosine / density * powerWeight(density, cosine / kPi);
  if (glm::dot(receiver.flatNormal, direction) <= 0.0) return out;
  const double side = glm::dot(light.normal, direction) < 0.0 ? 1.0 : -1.0;
  const glm::dvec3 there = light.position + side * scene_.offsetAt(light.position) * light.normal;
  if (!scene_.blocked(above(scene_, receiver), there)) out.seen = out.unoccluded;
  return out;
}

glm::dvec3 PathTracer::weightedEmission(const Hit& hit, const Receiver& receiver, const glm::dvec3& direction) const {
  const glm::dvec3 emitted = scene_.emitted(hit);
  if (emitted == glm::dvec3(0.0)) return emitted;
  const glm::dvec3 to = hit.position - receiver.position;
  const double cosineThere = std::abs(glm::dot(hit.flatNormal, direction));
  const double density = scene_.lightDensity(hit) * glm::dot(to, to) / std::max(cosineThere, 1e-12);
  return emitted * kPi * powerWeight(glm::dot(receiver.normal, direction) / kPi, density);
}

glm::dvec3 PathTracer::unoccludedAlong(const Receiver& receiver, const glm::dvec3& origin,
                                       const glm::dvec3& direction) const {
  glm::dvec3 sum(0.0);
  for (const Hit& hit : scene_.lightsAlong(origin, direction)) sum += weightedEmission(hit, receiver, direction);
  return sum;
}

PathSample PathTracer::sample(const Receiver& start, Sampler& sampler) const {
  PathSample out;
  glm::dvec3 sum(0.0);
  glm::dvec3 throughput(1.0);  // product of the albedos on the way, over the chances of going on
  Receiver receiver = start;
  for (int bounce = 0;; ++bounce) {
    const Direct light = fromLight(receiver, sampler.pair());
    const glm::dvec3 direction = cosineDirection(receiver.normal, sampler.pair());
    const glm::dvec3 origin = above(scene_, receiver);
    const bool leaves = glm::dot(direction, receiver.flatNormal) > 0.0;
    const std::optional<Hit> hit = leaves ? scene_.nearest(origin, direction) : std::nullopt;
    glm::dvec3 direct = light.seen;
    if (hit) direct += weightedEmission(*hit, receiver, direction);
    sum += throughput * direct;
    if (bounce == 0) {
      out.direct = direct;
      out.unoccluded = light.unoccluded + unoccludedAlong(receiver, origin, direction);
    }
    while (out.irradiance.size() < levels_.size() && levels_[out.irradiance.size()] <= bounce) {
      out.irradiance.push_back(sum);
    }
    if (out.irradiance.size() == levels_.size() || !hit) break;
    throughput *= scene_.albedo(*hit);
    const double brightest = std::max({throughput.x, throughput.y, throughput.z});
    if (brightest <= 0.0) break;
    if (bounce >= kRouletteFrom) {
      const double survival = std::min(kMostSurvival, brightest);
      if (sampler.one() >= survival) break;
      throughput /= survival;
    }
    receiver = receiverAt(*hit);
  }
  out.irradiance.resize(levels_.size(), sum);
  return out;
}

}  // namespace lpv::evaluation
