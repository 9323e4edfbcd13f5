#pragma once
// Irradiance at a point by path tracing: light sampling and cosine sampling, combined by the power heuristic (Veach
// 1997). Of several points on lights one is chosen by what it sends, for the shadow ray (resampling, Talbot et al.
// 2005).

#include <glm/glm.hpp>
#include <vector>

#include "renderer/sampler.h"
#include "renderer/traced_scene.h"

namespace lpv::evaluation {

/// Bounces without end.
inline constexpr int kAllBounces = 1 << 30;

/// Where irradiance is asked for.
struct Receiver {
  glm::dvec3 position{0.0};
  glm::dvec3 flatNormal{0.0};  ///< unit, of the triangle, on the side that receives: light from behind it is blocked
  glm::dvec3 normal{0.0};      ///< unit, for the cosine: interpolated where the mesh has normals
};

/// A receiver on the side that the ray came from.
Receiver receiverAt(const Hit& hit);

/// Irradiance in W/m^2 by one path.
struct PathSample {
  std::vector<glm::dvec3> irradiance;  ///< one per level: with so many bounces
  glm::dvec3 direct{0.0};              ///< without bounces
  glm::dvec3 unoccluded{0.0};          ///< without bounces, nothing in the light's way
  bool open = true;                    ///< nothing was found in the light's way
};

/// What one side of a surface gets. All surfaces are Lambertian; lights are black and opaque, backs of one-sided
/// surfaces too. Expectations of the samples are the irradiances; each number of bounces is counted without bias, "all"
/// by Russian roulette.
class PathTracer {
 public:
  /// `levels`: numbers of bounces, ascending.
  PathTracer(const TracedScene& scene, std::vector<int> levels) : scene_(scene), levels_(std::move(levels)) {}

  PathSample sample(const Receiver& receiver, Sampler& sampler) const;
  const std::vector<int>& levels() const { return levels_; }
  /// Whether nothing stands between.
  bool sees(const Receiver& receiver, const LightSample& light) const;

 private:
  struct Direct {
    glm::dvec3 seen{0.0};
    glm::dvec3 unoccluded{0.0};
    bool open = true;
  };
  Direct fromLight(const Receiver& receiver, int candidates, Sampler& sampler) const;
  /// What the point on the light would send, over its density, weighted.
  glm::dvec3 unoccludedFrom(const LightSample& light, const Receiver& receiver) const;
  glm::dvec3 weightedEmission(const Hit& hit, const Receiver& receiver, const glm::dvec3& direction) const;
  glm::dvec3 unoccludedAlong(const Receiver& receiver, const glm::dvec3& origin, const glm::dvec3& direction) const;

  const TracedScene& scene_;
  std::vector<int> levels_;
};

}  // namespace lpv::evaluation
