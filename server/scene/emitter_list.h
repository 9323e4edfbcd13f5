#pragma once
// Irradiance from the lights themselves, without a grid between (MATHS.md 3c): few polygons by the closed form
// (Lambert; Arvo 1995), everything else as VPLs through the light's tree. The GLSL twin is
// shaders/transport/emitter_list.glsl.

#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/grid.h"

namespace lpv {

/// Cells from an emitter: up to kNearFieldBegin receivers look at the lights, from kNearFieldEnd on at the volume.
inline constexpr double kNearFieldBegin = 2.0;
inline constexpr double kNearFieldEnd = 3.0;

/// A session's lights as receivers look at them: the texels that shaders/transport/emitter_list.glsl describes.
struct EmitterList {
  Grid grid;
  bool always = false;  ///< transport DIRECT: everywhere; else only near emitters, or outside the grid
  std::vector<glm::vec4> texels;
  std::vector<float> emitterDistance;  ///< per cell: cells from its centre to the nearest VPL; empty when `always`

  /// 1 where the volume is far enough from emitters, 0 where the lights are to be looked at, between them in between.
  double farFromEmitters(const glm::dvec3& world) const;
  /// W/m^2 at a world position on a surface with unit normal n.
  glm::dvec3 irradiance(const glm::dvec3& world, const glm::dvec3& n) const;
};
using DirectLightsPtr = std::shared_ptr<const EmitterList>;

/// E of unit radiance of a triangle, counter-clockwise seen from its front (from both sides when `sides` is 2), its
/// corners given from the receiver, cut at the horizon of n.
double triangleIrradiance(const glm::dvec3 (&corners)[3], const glm::dvec3& n, int sides);

/// What one VPL of unit radiance sends to a receiver (MATHS.md 3b.4; shaders/transport/vpl_kernel.glsl).
struct VplLight {
  double fluence = 0.0;
  glm::dvec3 vectorIrradiance{0.0};  ///< towards the light
};

/// `entry`: the first four texels of a VPL (shaders/transport/vpls.glsl), grid space, as `receiver` is. `sides` that
/// emit: 1 or 2.
VplLight lightFromVpl(const glm::vec4* entry, const glm::dvec3& receiver, int sides);

}  // namespace lpv
