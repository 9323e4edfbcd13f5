#pragma once
// Procedural textures.

#include <cstdint>
#include <functional>
#include <glm/glm.hpp>

#include "scene/texture.h"

namespace lpv::reference {

/// Linear floats (kRgb32F), texel (x, y) = value(x, y), y = 0 the first row (v = 0).
TexturePtr textureOf(int width, int height, const std::function<glm::dvec3(int x, int y)>& value);

/// Linear floats between 0 and 1, a different one in every texel and colour.
TexturePtr noise(int width, int height, std::uint32_t seed = 1);

/// 8-bit sRGB codes, rows from v = 0.
TexturePtr srgbTextureOf(int width, int height, const std::function<glm::u8vec3(int x, int y)>& code);

/// White with an alpha of 0..255, rows from v = 0.
TexturePtr alphaTextureOf(int width, int height, const std::function<std::uint8_t(int x, int y)>& alpha);

}  // namespace lpv::reference
