#pragma once
// Textures read in double.

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/texture.h"

namespace lpv::reference {

/// The value of an IEEE half.
double decodeHalf(std::uint16_t bits);

/// Linear RGB of one texel; coordinates wrap (repeat).
glm::dvec3 texel(const Texture& texture, int x, int y);

/// Bilinear at level 0: (0,0) is the outer corner of the first texel of the first row, repeat.
glm::dvec3 bilinear(const Texture& texture, const glm::dvec2& uv);

}  // namespace lpv::reference
