#pragma once
// Volumes whose cells have nothing to do with each other, in half floats as clients receive them, and where to look
// them up: for lookups in three languages, C++, GLSL and the page's WebGL2.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/volume.h"

namespace lpv::reference {

/// A point of a surface, world space.
struct LookupPoint {
  glm::vec3 position{0.0F};
  glm::vec3 normal{0.0F};  ///< unit
};

struct RandomVolume {
  Volume volume;  ///< of the halves, each times its layer's scale
  std::vector<float> scales;  ///< of layers, powers of two
  /// Of each colour the four coefficients of every cell, x fastest, layers above one another along z.
  std::array<std::vector<std::uint16_t>, 3> halves;
  /// Inside, beyond the outermost centres of cells, and outside.
  std::vector<LookupPoint> points;
};

/// The same list everywhere: grids of 1 to 9 cells along an edge, 1 to 3 layers, cells of 10^-3 to 10^3 in one volume,
/// |D| / phi from 0 to above 1, dark and negative cells.
std::vector<RandomVolume> randomVolumes();

}  // namespace lpv::reference
