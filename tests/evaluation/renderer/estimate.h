#pragma once
// Means over many paths, with their standard errors.

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "renderer/closed_form.h"
#include "renderer/path_tracer.h"

namespace lpv::evaluation {

/// How many paths, in how many replicates: sequences of their own scrambling, whose scatter is the standard error.
struct Sampling {
  int samples = 256;    ///< paths in all, at least `replicates`
  int replicates = 8;   ///< 2 at least
  std::uint32_t seed = 1;
  int threads = 1;

  int perReplicate() const { return (samples + replicates - 1) / replicates; }
};

/// Mean and standard error of the mean, per colour.
class Replicates {
 public:
  void add(const glm::dvec3& mean) {
    ++count_;
    sum_ += mean;
    squares_ += mean * mean;
  }
  glm::dvec3 mean() const { return sum_ / double(count_); }
  glm::dvec3 error() const {
    const double n = double(count_);
    return glm::sqrt(glm::max((squares_ - sum_ * sum_ / n) / (n * (n - 1.0)), glm::dvec3(0.0)));
  }

 private:
  int count_ = 0;
  glm::dvec3 sum_{0.0};
  glm::dvec3 squares_{0.0};
};

/// Irradiance at one receiver, W/m^2.
struct IrradianceEstimate {
  std::vector<glm::dvec3> mean;   ///< per level
  std::vector<glm::dvec3> error;  ///< standard error, per level
  glm::dvec3 direct{0.0};
  glm::dvec3 unoccluded{0.0};     ///< direct, nothing in the way
  glm::dvec3 unoccludedError{0.0};
};

/// `stream`: receivers of different streams get independent paths. `exact`: what would arrive with nothing in the way
/// is taken from it, and the direct part of every level is that times the share that paths found unhidden: without
/// noise where nothing or all is hidden, biased by the order of 1 / samples in penumbrae.
IrradianceEstimate estimateIrradiance(const PathTracer& tracer, const Receiver& receiver, const Sampling& sampling,
                                      std::uint32_t stream, const ClosedForm* exact = nullptr);

}  // namespace lpv::evaluation
