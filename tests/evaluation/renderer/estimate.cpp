#include "renderer/estimate.h"

namespace lpv::evaluation {

IrradianceEstimate estimateIrradiance(const PathTracer& tracer, const Receiver& receiver, const Sampling& sampling,
                                      std::uint32_t stream) {
  const std::size_t levels = tracer.levels().size();
  std::vector<Replicates> sums(levels);
  Replicates unoccluded;
  IrradianceEstimate out;
  for (int replicate = 0; replicate < sampling.replicates; ++replicate) {
    Sampler sampler(hashed(hashed(sampling.seed + stream) + std::uint32_t(replicate)));
    std::vector<glm::dvec3> mean(levels, glm::dvec3(0.0));
    glm::dvec3 unoccludedMean(0.0);
    const double share = 1.0 / sampling.perReplicate();
    for (int i = 0; i < sampling.perReplicate(); ++i) {
      sampler.start(std::uint32_t(i));
      const PathSample path = tracer.sample(receiver, sampler);
      for (std::size_t level = 0; level < levels; ++level) mean[level] += share * path.irradiance[level];
      out.direct += share / sampling.replicates * path.direct;
      unoccludedMean += share * path.unoccluded;
    }
    for (std::size_t level = 0; level < levels; ++level) sums[level].add(mean[level]);
    unoccluded.add(unoccludedMean);
  }
  out.unoccluded = unoccluded.mean();
  out.unoccludedError = unoccluded.error();
  for (const Replicates& sum : sums) {
    out.mean.push_back(sum.mean());
    out.error.push_back(sum.error());
  }
  return out;
}

}  // namespace lpv::evaluation
