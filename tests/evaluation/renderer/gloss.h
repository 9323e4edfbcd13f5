#pragma once
// Glossy surfaces as the camera sees them (scene/gloss.h): what their lobes reflect, by rays of the lobe and to points
// on lights (power heuristic; Veach 1997). What is met is Lambertian, and so is what lies beneath the lobe.

#include <glm/glm.hpp>
#include <vector>

#include "renderer/estimate.h"
#include "renderer/path_tracer.h"
#include "scene/gloss.h"

namespace lpv::evaluation {

/// Whether the surface that was hit has a lobe.
bool isGlossy(const TracedScene& scene, const Hit& hit);

/// The lobe of a surface that was hit by a ray from `eye`.
class GlossTracer {
 public:
  GlossTracer(const TracedScene& scene, const PathTracer& tracer, const Hit& hit, const glm::dvec3& eye);

  /// Of light from everywhere by the albedo, what remains.
  double diffuse() const { return diffuse_; }
  /// Radiance by the lobe, one path: with so many bounces before what the lobe reflects of surfaces, per level.
  std::vector<glm::dvec3> sample(Sampler& sampler) const;

 private:
  glm::dvec3 fromLight(Sampler& sampler) const;

  const TracedScene& scene_;
  const PathTracer& tracer_;
  Receiver receiver_;
  glm::dvec3 v_{0.0};
  GlossLobe lobe_;
  glm::dvec3 gain_{1.0};
  double diffuse_ = 1.0;
};

/// Mean and standard error of GlossTracer::sample() per level; streams as for estimateIrradiance().
struct GlossEstimate {
  std::vector<glm::dvec3> mean, error;
};
GlossEstimate estimateGloss(const GlossTracer& tracer, std::size_t levels, const Sampling& sampling,
                            std::uint32_t stream);

}  // namespace lpv::evaluation
