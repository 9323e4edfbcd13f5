#include "reference/texel.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "reference/display.h"

namespace lpv::reference {
namespace {

int wrap(int i, int size) { return ((i % size) + size) % size; }

}  // namespace

double decodeHalf(std::uint16_t bits) {
  const int exponent = (bits >> 10) & 0x1f;
  const int fraction = bits & 0x3ff;
  const double sign = (bits & 0x8000) ? -1.0 : 1.0;
  if (exponent == 0x1f) {
    return fraction ? std::numeric_limits<double>::quiet_NaN() : sign * std::numeric_limits<double>::infinity();
  }
  if (exponent == 0) return sign * std::ldexp(fraction, -24);
  return sign * std::ldexp(1024 + fraction, exponent - 25);
}

glm::dvec3 texel(const Texture& texture, int x, int y) {
  const std::size_t column = std::size_t(wrap(x, texture.width));
  const std::size_t row = std::size_t(wrap(y, texture.height));
  const std::size_t first = (row * std::size_t(texture.width) + column) * (hasAlpha(texture) ? 4 : 3);
  glm::dvec3 out(0.0);
  for (int c = 0; c < 3; ++c) {
    const std::size_t i = first + std::size_t(c);
    if (texture.format == TexelFormat::kRgb8Srgb || hasAlpha(texture)) {
      out[c] = decodeSrgb(texture.texels.at(i) / 255.0);
    } else if (texture.format == TexelFormat::kRgb16F) {
      out[c] = decodeHalf(std::uint16_t(texture.texels.at(2 * i) | (texture.texels.at(2 * i + 1) << 8)));
    } else {
      float value = 0.0F;
      std::memcpy(&value, &texture.texels.at(4 * i), sizeof value);
      out[c] = double(value);
    }
  }
  return out;
}

glm::dvec3 bilinear(const Texture& texture, const glm::dvec2& uv) {
  const double x = uv.x * texture.width - 0.5;
  const double y = uv.y * texture.height - 0.5;
  const int left = int(std::floor(x));
  const int top = int(std::floor(y));
  const double fx = x - left;
  const double fy = y - top;
  const glm::dvec3 upper = (1.0 - fx) * texel(texture, left, top) + fx * texel(texture, left + 1, top);
  const glm::dvec3 lower = (1.0 - fx) * texel(texture, left, top + 1) + fx * texel(texture, left + 1, top + 1);
  return (1.0 - fy) * upper + fy * lower;
}

}  // namespace lpv::reference
