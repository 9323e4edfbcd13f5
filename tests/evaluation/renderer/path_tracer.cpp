#include "renderer/path_tracer.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace lpv::evaluation {

namespace {

constexpr double kPi = glm::pi<double>();
constexpr int kFirstCandidates = 16;      ///< points on lights per shadow ray, at the receiver itself
constexpr int kCandidates = 4;            ///< ... and at the bounces
constexpr double kGolden = 0.6180339887498949;
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

double sum(const glm::dvec3& v) { return v.x + v.y + v.z; }

double powerWeight(double mine, double other) { return mine * mine / (mine * mine + other * other); }

glm::dvec3 above(const TracedScene& scene, const Receiver& receiver) {
  return receiver.position + scene.offsetAt(receiver.position) * receiver.flatNormal;
}

}  // namespace

Receiver receiverAt(const Hit& hit) {
  const double side = hit.front ? 1.0 : -1.0;
  return {hit.position, side * hit.flatNormal, side * hit.normal};
}

glm::dvec3 PathTracer::unoccludedFrom(const LightSample& light, const Receiver& receiver) const {
  const glm::dvec3 to = light.position - receiver.position;
  const double distance = glm::length(to);
  if (distance <= 0.0) return glm::dvec3(0.0);
  const glm::dvec3 direction = to / distance;
  const double cosine = glm::dot(receiver.normal, direction);
  double cosineThere = -glm::dot(light.normal, direction);
  if (light.twoSided) cosineThere = std::abs(cosineThere);
  if (cosine <= 0.0 || cosineThere <= 0.0) return glm::dvec3(0.0);
  const double density = light.density * distance * distance / cosineThere;  // per sr
  return light.radiance * cosine / density * powerWeight(density, cosine / kPi);
}

bool PathTracer::sees(const Receiver& receiver, const LightSample& light) const {
  const glm::dvec3 direction = light.position - receiver.position;
  if (glm::dot(receiver.flatNormal, direction) <= 0.0) return false;
  const double side = glm::dot(light.normal, direction) < 0.0 ? 1.0 : -1.0;
  const glm::dvec3 there = light.position + side * scene_.offsetAt(light.position) * light.normal;
  return !scene_.blocked(above(scene_, receiver), there);
}

PathTracer::Direct PathTracer::fromLight(const Receiver& receiver, int candidates, Sampler& sampler) const {
  Direct out;
  if (!scene_.hasLights()) return out;
  const glm::dvec2 random = sampler.pair();
  double choice = sampler.one();
  LightSample chosen;
  glm::dvec3 chosenSends(0.0);
  double weights = 0.0;
  for (int i = 0; i < candidates; ++i) {
    const LightSample light =
        scene_.sampleLight(glm::fract(random + double(i) * glm::dvec2(1.0 / candidates, kGolden)));
    const glm::dvec3 sends = unoccludedFrom(light, receiver);
    const double weight = sum(sends);
    out.unoccluded += sends / double(candidates);
    weights += weight;
    if (weight <= 0.0) continue;
    const double share = weight / weights;  // what is left of `choice` decides about the later ones
    if (choice < share) {
      chosen = light;
      chosenSends = sends;
      choice /= share;
    } else {
      choice = (choice - share) / (1.0 - share);
    }
  }
  out.open = weights <= 0.0 || sees(receiver, chosen);
  if (weights > 0.0 && out.open) out.seen = chosenSends * (weights / sum(chosenSends) / candidates);
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
  glm::dvec3 total(0.0);
  for (const Hit& hit : scene_.lightsAlong(origin, direction)) total += weightedEmission(hit, receiver, direction);
  return total;
}

PathSample PathTracer::sample(const Receiver& start, Sampler& sampler) const {
  PathSample out;
  glm::dvec3 total(0.0);
  glm::dvec3 throughput(1.0);  // product of the albedos on the way, over the chances of going on
  Receiver receiver = start;
  for (int bounce = 0;; ++bounce) {
    const Direct light = fromLight(receiver, bounce == 0 ? kFirstCandidates : kCandidates, sampler);
    const glm::dvec3 direction = cosineDirection(receiver.normal, sampler.pair());
    const glm::dvec3 origin = above(scene_, receiver);
    const bool leaves = glm::dot(direction, receiver.flatNormal) > 0.0;
    const std::optional<Hit> hit = leaves ? scene_.nearest(origin, direction) : std::nullopt;
    const glm::dvec3 met = hit ? weightedEmission(*hit, receiver, direction) : glm::dvec3(0.0);
    const glm::dvec3 direct = light.seen + met;
    total += throughput * direct;
    if (bounce == 0) {
      out.direct = direct;
      const glm::dvec3 behind = unoccludedAlong(receiver, origin, direction);
      out.unoccluded = light.unoccluded + behind;
      out.open = light.open && behind == met;
    }
    while (out.irradiance.size() < levels_.size() && levels_[out.irradiance.size()] <= bounce) {
      out.irradiance.push_back(total);
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
  out.irradiance.resize(levels_.size(), total);
  return out;
}

}  // namespace lpv::evaluation
