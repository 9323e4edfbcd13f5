#pragma once
// How much of each light a point of a surface sees, on the CPU, for probes (MATHS.md 3d). The GPU's twin is
// shaders/frame/shadow_rays.comp.

#include <cstddef>
#include <deque>
#include <glm/glm.hpp>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "scene/haze.h"
#include "scene/light_points.h"
#include "scene/occluders.h"
#include "scene/scene.h"

namespace lpv {

/// Of one scene. Made ready by the first question, which may take as long as the trees over new meshes take.
/// Thread-safe.
class LightVisibility {
 public:
  /// `ofLights`: something may be in the way of the lights' own light; else share() is 1, and only seen() is in
/// question.
  explicit LightVisibility(ScenePtr scene, bool ofLights = true) : scene_(std::move(scene)), ofLights_(ofLights) {}

  /// Per colour, the share of what `light` would send that arrives: 1 where nothing lies between. `light` counts those
  /// that emit, in the order of names. World space; n is a unit vector.
  glm::dvec3 share(const glm::dvec3& at, const glm::dvec3& n, std::size_t light) const;
  /// A point of a light as a place sees it that is on no surface.
  struct PointSeen {
    glm::dvec3 direction{0.0};  ///< unit, towards it
    glm::dvec3 fluence{0.0};  ///< per colour, of unit radiance, with nothing in the way
    glm::dvec3 share{1.0};  ///< of it, what arrives
  };
  /// Those that shine on the place; none where nothing may be in the way of lights.
  std::vector<PointSeen> pointsSeen(const glm::dvec3& at, std::size_t light) const;
  /// Per colour, the share of light from a place on a surface that gets to a point with unit normal n; n is 0 for a
  /// point that is on no surface.
  glm::dvec3 seen(const glm::dvec3& at, const glm::dvec3& n, const glm::dvec3& place) const;
  /// What a point with unit normal n, or none, first sees in a direction, a unit vector, of what stops all light; and
  /// per colour what gets here from there.
  struct Sight {
    OccluderHit hit;
    glm::dvec3 share{1.0};
  };
  std::optional<Sight> sight(const glm::dvec3& at, const glm::dvec3& n, const glm::dvec3& direction) const;

 private:
  struct Emitter {
    LightPtr light;
    LightPoints points;  ///< world space
    mutable std::once_flag once;
    mutable LightPoints finer;  ///< more of them, made where the light is nearly hidden
  };
  /// What a point would get of some points of a light, what it gets, and from how many of them.
  struct Arrived {
    glm::dvec3 all{0.0}, seen{0.0};
    std::size_t sending = 0, arriving = 0;
  };
  void prepare() const;
  Arrived arrived(const glm::dvec3& from, const glm::dvec3& n, std::size_t light, const LightPoints& points) const;
  const LightPoints& finerPoints(const Emitter& emitter) const;

  ScenePtr scene_;
  bool ofLights_;
  mutable std::once_flag once_;
  mutable std::unique_ptr<const Occluders> occluders_;
  mutable std::deque<Emitter> emitters_;
  mutable bool refines_ = false;  ///< there is room for finer points of every light
  mutable double offset_ = 0.0;  ///< metres, along a receiver's normal to where rays begin
  mutable Bounds bounds_;  ///< of the surfaces
  mutable Haze haze_;
  mutable bool panes_ = false;  ///< something lets light through
};
using LightVisibilityPtr = std::shared_ptr<const LightVisibility>;

}  // namespace lpv
