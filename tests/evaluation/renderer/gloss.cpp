#include "renderer/gloss.h"

#include <algorithm>
#include <glm/gtc/constants.hpp>
#include <optional>

namespace lpv::evaluation {

namespace {

double powerShare(double mine, double other) {
  const double ratio = other / mine;  // of densities that may be as large as a mirror's
  return 1.0 / (1.0 + ratio * ratio);
}

}  // namespace

bool isGlossy(const TracedScene& scene, const Hit& hit) {
  const Finish finish = scene.finish(hit);
  return !scene.objects()[hit.object].emits && (finish.metalness > 0.0 || finish.roughness < 1.0);
}

GlossTracer::GlossTracer(const TracedScene& scene, const PathTracer& tracer, const Hit& hit, const glm::dvec3& eye)
    : scene_(scene), tracer_(tracer), receiver_(receiverAt(hit)), v_(glm::normalize(eye - hit.position)) {
  const Finish finish = scene.finish(hit);
  lobe_ = GlossLobe::of(scene.albedo(hit), finish.roughness, finish.metalness);
  const GlossShare share = glossShare(std::max(glm::dot(receiver_.normal, v_), 1e-3), lobe_.alpha);
  gain_ = share.gain(lobe_.straight);
  diffuse_ = (1.0 - finish.metalness) * (1.0 - share.of(glm::dvec3(kDielectricReflectance)).x);
}

glm::dvec3 GlossTracer::fromLight(Sampler& sampler) const {
  if (!scene_.hasLights()) return glm::dvec3(0.0);
  const LightSample light = scene_.sampleLight(sampler.pair());
  const glm::dvec3 to = light.position - receiver_.position;
  const double distance2 = glm::dot(to, to);
  if (distance2 <= 0.0) return glm::dvec3(0.0);
  const glm::dvec3 direction = to / std::sqrt(distance2);
  double cosineThere = -glm::dot(light.normal, direction);
  if (light.twoSided) cosineThere = std::abs(cosineThere);
  const double cosine = glm::dot(receiver_.normal, direction);
  if (cosine <= 0.0 || cosineThere <= 0.0 || !tracer_.sees(receiver_, light)) return glm::dvec3(0.0);
  const double density = light.density * distance2 / cosineThere;  // per sr
  const double share = powerShare(density, lobe_.density(receiver_.normal, v_, direction));
  return light.radiance * lobe_.single(receiver_.normal, v_, direction) * (cosine / density * share);
}

std::vector<glm::dvec3> GlossTracer::sample(Sampler& sampler) const {
  std::vector<glm::dvec3> out(tracer_.levels().size(), gain_ * fromLight(sampler));
  const glm::dvec3 direction = lobe_.direction(receiver_.normal, v_, sampler.pair());
  const double cosine = glm::dot(receiver_.normal, direction);
  if (cosine <= 0.0 || glm::dot(receiver_.flatNormal, direction) <= 0.0) return out;
  const glm::dvec3 origin = receiver_.position + scene_.offsetAt(receiver_.position) * receiver_.flatNormal;
  const std::optional<Hit> hit = scene_.nearest(origin, direction);
  if (!hit) return out;
  const double density = lobe_.density(receiver_.normal, v_, direction);
  const glm::dvec3 worth = gain_ * lobe_.single(receiver_.normal, v_, direction) * (cosine / density);
  const glm::dvec3 emitted = scene_.emitted(*hit), albedo = scene_.albedo(*hit);
  if (emitted != glm::dvec3(0.0)) {
    const glm::dvec3 to = hit->position - receiver_.position;
    const double cosineThere = std::max(std::abs(glm::dot(hit->flatNormal, direction)), 1e-12);
    const double ofLights = scene_.lightDensity(*hit) * glm::dot(to, to) / cosineThere;
    for (glm::dvec3& level : out) level += worth * emitted * powerShare(density, ofLights);
  }
  if (albedo == glm::dvec3(0.0)) return out;
  const PathSample path = tracer_.sample(receiverAt(*hit), sampler);
  for (std::size_t i = 0; i < out.size(); ++i) out[i] += worth * albedo * path.irradiance[i] / glm::pi<double>();
  return out;
}

GlossEstimate estimateGloss(const GlossTracer& tracer, std::size_t levels, const Sampling& sampling,
                            std::uint32_t stream) {
  std::vector<Replicates> sums(levels);
  for (int replicate = 0; replicate < sampling.replicates; ++replicate) {
    Sampler sampler(hashed(hashed(sampling.seed + stream + 0x51f15eU) + std::uint32_t(replicate)));
    std::vector<glm::dvec3> mean(levels, glm::dvec3(0.0));
    for (int k = 0; k < sampling.perReplicate(); ++k) {
      sampler.start(std::uint32_t(k));
      const std::vector<glm::dvec3> path = tracer.sample(sampler);
      for (std::size_t i = 0; i < levels; ++i) mean[i] += path[i] / double(sampling.perReplicate());
    }
    for (std::size_t i = 0; i < levels; ++i) sums[i].add(mean[i]);
  }
  GlossEstimate out;
  for (const Replicates& sum : sums) {
    out.mean.push_back(sum.mean());
    out.error.push_back(sum.error());
  }
  return out;
}

}  // namespace lpv::evaluation
