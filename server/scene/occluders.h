#pragma once
// What stands in the way of light: the meshes of surfaces and lights as a BVH over BVHs (MATHS.md 3d). A surface stops
// light of all lights, or as much of it as it covers; a light blocks its own and what surfaces reflect, but not that
// of other lights, which see it where it is a surface, too.

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene.h"
#include "scene/transparency.h"
#include "scene/triangle_bvh.h"

namespace lpv {

/// Of an occluder: it blocks everything. Of a ray: surfaces alone block it.
inline constexpr int kAllLights = -1;
/// Of an occluder: it blocks what surfaces reflect, and no light. Of a ray: light that a surface reflects, which
/// everything blocks.
inline constexpr int kFromSurfaces = -2;

struct Occluder {
  MeshPtr mesh;
  glm::dmat4 worldFromObject{1.0};
  /// kAllLights, kFromSurfaces, or the one light that it blocks besides, among those that emit in the order of names.
  int blocks = kAllLights;
  Coverage coverage;  ///< opaque, or what of it stops light
  int surface = -1;  ///< which one of the scene's, in the order of names; -1: a light
  int light = -1;  ///< which one of those that emit, in the order of names; -1: a surface
  bool textured = false;  ///< it has a picture that reflections show
  int reflects = 0;  ///< sides of a surface that do: 1, its front, and 2, its back
  int shows = 0;  ///< sides of a surface that cameras see, the same

  bool operator==(const Occluder&) const = default;
};

/// Of a scene, surfaces first, in the order of names: those that cast shadows and do not let all light through. Lights
/// that are convex shadow nothing of themselves: they are there where surfaces reflect, and where reflections show
/// them.
std::vector<Occluder> occludersOf(const Scene& scene);

/// The BVH over occluders in a space that `spaceFromWorld` leads to: its leaves have one item each.
Bvh bvhOf(const std::vector<Occluder>& occluders, const glm::dmat4& spaceFromWorld);

/// What a ray sees of what stops all light.
struct OccluderHit {
  int surface = -1;  ///< Occluder::surface
  std::uint32_t triangle = 0;  ///< of its mesh
  bool front = true;
  glm::dvec3 position{0.0};
};

/// Answers rays on the CPU. World space. Immutable.
class Occluders {
 public:
  explicit Occluders(const Scene& scene);

  /// Whether nothing of light of `light` (see Occluder::blocks) gets from one point to the other, by what lies strictly
  /// between.
  bool blocked(const glm::dvec3& from, const glm::dvec3& to, int light) const;
  /// Per colour, what gets there, 0..1.
  glm::dvec3 transmitted(const glm::dvec3& from, const glm::dvec3& to, int light) const;
  /// The first opaque surface or light strictly between two points.
  std::optional<OccluderHit> firstHit(const glm::dvec3& from, const glm::dvec3& to) const;

 private:
  struct Instance {
    TriangleBvhPtr bvh;
    glm::dmat4 objectFromWorld{1.0};
    int blocks = kAllLights;
    MeshPtr mesh;
    Coverage coverage;
    bool opaque = true;
    int surface = -1;

    glm::dvec3 transmitted(const glm::dvec3& from, const glm::dvec3& to) const;
  };
  /// Calls visit(instance, from, to), both in the instance's space, for those that the segment may meet, until it says
  /// false.
  template <typename Visit>
  void walk(const glm::dvec3& from, const glm::dvec3& to, const Visit& visit) const;

  std::vector<BvhNode> nodes_;
  std::vector<Instance> instances_;  ///< in the order of leaves
};

}  // namespace lpv
