#pragma once
// Irradiance from the lights themselves, without a grid between (MATHS.md 3c): few polygons by the closed form
// (Lambert; Arvo 1995), everything else as VPLs through the light's tree. The GLSL twin is
// shaders/transport/emitter_list.glsl.

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "scene/grid.h"
#include "scene/light_visibility.h"
#include "scene/reflected_light.h"

namespace lpv {

/// Distances from an emitter, cells: receivers nearer than kNearFieldBegin use the lights, beyond kNearFieldEnd the
/// volume.
inline constexpr double kNearFieldBegin = 2.0;
inline constexpr double kNearFieldEnd = 3.0;

/// A light of constant radiance without directions is looked at as polygons, which is exact, while it has no more
/// triangles than this, its flat patches merged; other lights are their trees. The near field of GATHER, and DIRECT
/// with a rule below kAccurateOpeningRatio, where time counts;
inline constexpr std::size_t kFewPolygons = 32;
/// DIRECT with kAccurateOpeningRatio or above: 720 triangles cost a receiver 2-3x the walk through their tree.
inline constexpr std::size_t kMostPolygons = 1024;
/// All lights together, smallest first: a thread's loops have an end on llvmpipe (kMaxRounds).
inline constexpr std::size_t kMostPolygonsOfAll = 4096;

/// A session's lights for lookups of the near field: the texels that shaders/transport/emitter_list.glsl describes.
struct EmitterList {
  Grid grid;  ///< of the field, guard cells included: what texels and distances are in
  bool always = false;  ///< used everywhere; else only near emitters or beyond the cells' centres
  LightVisibilityPtr visibility;  ///< null where nothing stands in the lights' way
  ReflectedLightPtr reflected;  ///< null without bounces
  std::vector<glm::vec4> texels;
  std::vector<float> emitterDistance;  ///< per cell: cells from its centre to the nearest VPL; empty when `always`

  /// Weight of the volume's irradiance: 0 nearer than kNearFieldBegin and beyond the outermost cell centres, 1 beyond
  /// kNearFieldEnd, smoothstep in between.
  double farFromEmitters(const glm::dvec3& world) const;
  /// W/m^2 at a world position on a surface with unit normal n, and the same of the lights alone with nothing in their
  /// way.
  glm::dvec3 irradiance(const glm::dvec3& world, const glm::dvec3& n) const;
  glm::dvec3 unoccluded(const glm::dvec3& world, const glm::dvec3& n) const { return fromLights(world, n, nullptr); }
  /// The shares of lights that receivers look at wherever they are (scene/small_lights.h): beside what is looked up.
  glm::dvec3 lookedAt(const glm::dvec3& world, const glm::dvec3& n) const;

 private:
  glm::dvec3 fromLights(const glm::dvec3& world, const glm::dvec3& n, const LightVisibility* through) const;
  glm::dvec3 fromLight(std::size_t light, const glm::dvec3& x, const glm::dvec3& n) const;
};
using EmitterListPtr = std::shared_ptr<const EmitterList>;

/// Irradiance of a triangle with unit radiance, clipped at the horizon of n. Corners are relative to the receiver, in
/// counter-clockwise order seen from the front; `sides` 2: it emits from both sides.
double triangleIrradiance(const glm::dvec3 (&corners)[3], const glm::dvec3& n, int sides);

/// What arrives at a point from a light of unit radiance.
struct Arriving {
  double fluence = 0.0;
  glm::dvec3 vectorIrradiance{0.0};  ///< towards the light
};

/// Of a triangle, seen as in triangleIrradiance, by the closed forms (MATHS.md 5; Van Oosterom & Strackee 1983).
Arriving triangleMoments(const glm::dvec3 (&corners)[3], int sides);

/// Of one VPL (MATHS.md 3b.4; shaders/transport/vpl_kernel.glsl). `entry`: the first four texels of a VPL
/// (shaders/transport/vpls.glsl), grid space, as `receiver` is. `sides` that emit: 1 or 2.
Arriving lightFromVpl(const glm::vec4* entry, const glm::dvec3& receiver, int sides);

}  // namespace lpv
