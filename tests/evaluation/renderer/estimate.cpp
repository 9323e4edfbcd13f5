#include "renderer/estimate.h"

namespace lpv::evaluation {

namespace {

/// Means over the paths of one replicate.
struct Replicate {
  std::vector<glm::dvec3> levels;
  glm::dvec3 direct{0.0};
  glm::dvec3 unoccluded{0.0};
  bool open = true;  ///< no path found anything in the light's way
};

Replicate replicateOf(const PathTracer& tracer, const Receiver& receiver, int samples, std::uint32_t seed) {
  Replicate out;
  out.levels.assign(tracer.levels().size(), glm::dvec3(0.0));
  Sampler sampler(seed);
  const double share = 1.0 / samples;
  for (int i = 0; i < samples; ++i) {
    sampler.start(std::uint32_t(i));
    const PathSample path = tracer.sample(receiver, sampler);
    for (std::size_t level = 0; level < out.levels.size(); ++level) {
      out.levels[level] += share * path.irradiance[level];
    }
    out.direct += share * path.direct;
    out.unoccluded += share * path.unoccluded;
    out.open = out.open && path.open;
  }
  return out;
}

/// Corrects every estimate by what is known of the light that would arrive with nothing in the way: direct light
/// becomes the exact value times the share that was seen, the ratio estimator of Heitz, Hill and McGuire 2018; the
/// exact value itself where no path found anything in the way.
void takeExact(std::vector<Replicate>& replicates, const glm::dvec3& exact) {
  glm::dvec3 direct(0.0);
  glm::dvec3 unoccluded(0.0);
  bool open = true;
  for (const Replicate& r : replicates) {
    direct += r.direct;
    unoccluded += r.unoccluded;
    open = open && r.open;
  }
  glm::dvec3 seen(0.0);
  for (int c = 0; c < 3; ++c) seen[c] = unoccluded[c] > 0.0 ? direct[c] / unoccluded[c] : 0.0;
  for (Replicate& r : replicates) {
    const glm::dvec3 correction = open ? exact - r.direct : seen * (exact - r.unoccluded);
    for (glm::dvec3& level : r.levels) level += correction;
    r.direct += correction;
    r.unoccluded = exact;
  }
}

}  // namespace

IrradianceEstimate estimateIrradiance(const PathTracer& tracer, const Receiver& receiver, const Sampling& sampling,
                                      std::uint32_t stream, const ClosedForm* exact) {
  std::vector<Replicate> replicates;
  for (int i = 0; i < sampling.replicates; ++i) {
    const std::uint32_t seed = hashed(hashed(sampling.seed + stream) + std::uint32_t(i));
    replicates.push_back(replicateOf(tracer, receiver, sampling.perReplicate(), seed));
  }
  if (exact != nullptr) takeExact(replicates, exact->irradiance(receiver.position, receiver.normal));
  IrradianceEstimate out;
  Replicates direct, unoccluded;
  std::vector<Replicates> levels(tracer.levels().size());
  for (const Replicate& r : replicates) {
    direct.add(r.direct);
    unoccluded.add(r.unoccluded);
    for (std::size_t level = 0; level < levels.size(); ++level) levels[level].add(r.levels[level]);
  }
  out.direct = direct.mean();
  out.unoccluded = unoccluded.mean();
  out.unoccludedError = unoccluded.error();
  for (const Replicates& level : levels) {
    out.mean.push_back(level.mean());
    out.error.push_back(level.error());
  }
  return out;
}

}  // namespace lpv::evaluation
