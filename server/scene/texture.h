#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "base/status.h"
#include "scene/mesh.h"

namespace lpv {

enum class TexelFormat {
  kRgb8Srgb,  ///< 3 bytes, sRGB-coded; decoded to linear before filtering
  kRgb16F,    ///< 3 IEEE halves, linear
  kRgb32F,    ///< 3 floats, linear
  kRgba8Srgb, ///< 4 bytes: sRGB-coded colour, alpha
  kRgb8,      ///< 3 bytes, linear
};

/// Bytes of one texel.
std::size_t texelBytes(TexelFormat format);

/// A picture: albedo of a surface, with its alpha where there is one, its normals, or radiance multiplier of a light.
/// Rows from top (v = 0) to bottom, tightly packed, little-endian. Wrap: repeat.
struct Texture {
  int width = 0;   ///< texels, 1..16384
  int height = 0;  ///< texels, 1..16384
  TexelFormat format = TexelFormat::kRgb8Srgb;
  std::vector<std::uint8_t> texels;
  BlobHash hash;
};
using TexturePtr = std::shared_ptr<const Texture>;

/// INVALID_ARGUMENT when a size is out of range, the bytes are not width x height x texelBytes, or a float texel is
/// negative or not finite.
Status checkTexture(const Texture& texture);

/// Appends row `row` (0 is the first) as linear RGB. The texture passed checkTexture.
void appendLinearRow(const Texture& texture, int row, std::vector<glm::vec3>& out);

/// Whether the format has alpha.
bool hasAlpha(const Texture& texture);

/// Appends the alpha of row `row`, of 255; 255 where the format has none.
void appendAlphaRow(const Texture& texture, int row, std::vector<std::uint8_t>& out);

}  // namespace lpv
