#pragma once
// Patches of the surfaces, from which light is reflected (MATHS.md 6, invariant 13): points that stand for the area
// around them, on each side that can be lit.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <optional>
#include <vector>

#include "scene/scene.h"

namespace lpv {

/// World space, metres.
struct Patch {
  glm::vec3 position{0.0F};
  float area = 0.0F;       ///< m^2
  glm::vec3 normal{0.0F};  ///< unit, of the side that it is on
  glm::vec3 albedo{0.0F};  ///< mean of alpha x albedo around it
  std::optional<std::array<glm::vec3, 3>>
      triangle;  ///< counter-clockwise seen from its side; none: it stands for several
};

/// Patches of a scene's surfaces by quality, about.
inline constexpr std::size_t kFastPatches = 1024;
inline constexpr std::size_t kAccuratePatches = 2048;

/// About `count`, of about the same area: large triangles are cut evenly, of small ones some stand for their
/// neighbours. Every surface has one for each of its sides at least, unless there are more surfaces than half of
/// `count`; twice `count` are the most. The same scene gives the same patches.
std::vector<Patch> patchesOf(const Scene& scene, std::size_t count);

/// The number of bounces after which what light is still under way is less than a third of the wanted error, bounded by
/// the highest albedo; `bounces` itself where it is not kAutoBounces. 0 without surfaces that reflect.
int bouncesFor(const Scene& scene);

}  // namespace lpv
