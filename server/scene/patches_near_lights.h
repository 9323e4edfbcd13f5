#pragma once
// Finer patches where lights are nearer to a surface than its patches are large (MATHS.md 3d.4): what a lamp sends to a
// ceiling close behind it is a spot, of which much is seen by the lamp alone.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/light_points.h"
#include "scene/patches.h"

namespace lpv {

/// A light in some of its points, world space.
struct LightInPoints {
  LightPoints points;
  double brightness = 0.0;  ///< W/(sr m^2), the mean of the colours
  bool twoSided = false;
};

/// A light, with a ball around its points.
struct LightBall {
  explicit LightBall(const LightInPoints& light);

  const LightInPoints& of;
  glm::dvec3 middle{0.0};
  double radius = 0.0;
};

/// Which patches to halve, in turn: halving patch i puts one half in its place and the other behind the last, and later
/// halvings count these. Those come first that get the most light from points within twice their radius, of which the
/// light itself does not see most, until all together get less than a hundredth of what lights send, or `most` have
/// been halved. Only patches that are a triangle are; none where no light is near.
std::vector<std::uint32_t> halvingsNearLights(const std::vector<Patch>& patches,
                                              const std::vector<LightInPoints>& lights, std::size_t most);

/// The scene's patches, so halved: those before stay where they are.
PatchedScene halved(const PatchedScene& patched, const std::vector<std::uint32_t>& halvings);

}  // namespace lpv
