#include "scene/texture.h"

#include <array>
#include <cmath>
#include <cstring>
#include <glm/gtc/packing.hpp>
#include <string>

namespace lpv {
namespace {

constexpr int kMaxEdge = 16384;

/// sRGB to linear (IEC 61966-2-1).
const std::array<float, 256>& linearOfSrgb() {
  static const std::array<float, 256> table = [] {
    std::array<float, 256> values{};
    for (std::size_t i = 0; i < values.size(); ++i) {
      const double c = double(i) / 255.0;
      values[i] = float(c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4));
    }
    return values;
  }();
  return table;
}

std::size_t componentsOf(TexelFormat format) { return format == TexelFormat::kRgba8Srgb ? 4 : 3; }

/// Component `i` of all texels, linear; not of alpha.
float linearComponent(const Texture& texture, std::size_t i) {
  switch (texture.format) {
    case TexelFormat::kRgb8Srgb:
    case TexelFormat::kRgba8Srgb:
      return linearOfSrgb()[texture.texels[i]];
    case TexelFormat::kRgb8:
      return float(texture.texels[i]) / 255.0F;
    case TexelFormat::kRgb16F: {
      std::uint16_t bits = 0;
      std::memcpy(&bits, &texture.texels[2 * i], sizeof bits);
      return glm::unpackHalf1x16(bits);
    }
    case TexelFormat::kRgb32F:
      break;
  }
  float value = 0.0F;
  std::memcpy(&value, &texture.texels[4 * i], sizeof value);
  return value;
}

bool radianceTexel(float value) { return std::isfinite(value) && value >= 0.0F; }

}  // namespace

std::size_t texelBytes(TexelFormat format) {
  switch (format) {
    case TexelFormat::kRgb8Srgb:
    case TexelFormat::kRgb8:
      return 3;
    case TexelFormat::kRgb16F:
      return 6;
    case TexelFormat::kRgb32F:
      return 12;
    case TexelFormat::kRgba8Srgb:
      return 4;
  }
  return 0;
}

Status checkTexture(const Texture& texture) {
  if (texture.width < 1 || texture.width > kMaxEdge) {
    return invalid("width", "width is " + std::to_string(texture.width) + " texels, allowed are 1..16384");
  }
  if (texture.height < 1 || texture.height > kMaxEdge) {
    return invalid("height", "height is " + std::to_string(texture.height) + " texels, allowed are 1..16384");
  }
  const std::size_t want = std::size_t(texture.width) * std::size_t(texture.height) * texelBytes(texture.format);
  if (texture.texels.size() != want) {
    return invalid("texels", "texels has " + std::to_string(texture.texels.size()) + " bytes, " +
                                 std::to_string(texture.width) + " x " + std::to_string(texture.height) +
                                 " texels of this format are " + std::to_string(want));
  }
  if (texelBytes(texture.format) <= 4) return {};  // bytes, of any value
  const bool half = texture.format == TexelFormat::kRgb16F;
  const std::size_t step = half ? sizeof(std::uint16_t) : sizeof(float);
  for (std::size_t i = 0; i < want; i += step) {
    float value = 0.0F;
    if (half) {
      std::uint16_t bits = 0;
      std::memcpy(&bits, &texture.texels[i], sizeof bits);
      value = glm::unpackHalf1x16(bits);
    } else {
      std::memcpy(&value, &texture.texels[i], sizeof value);
    }
    if (radianceTexel(value)) continue;
    return invalid("texels", "texel " + std::to_string(i / step / 3) + " is " + std::to_string(value) +
                                 "; allowed are finite values >= 0");
  }
  return {};
}

void appendLinearRow(const Texture& texture, int row, std::vector<glm::vec3>& out) {
  const auto width = std::size_t(texture.width);
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t i = componentsOf(texture.format) * (std::size_t(row) * width + x);
    out.emplace_back(linearComponent(texture, i), linearComponent(texture, i + 1), linearComponent(texture, i + 2));
  }
}

bool hasAlpha(const Texture& texture) { return texture.format == TexelFormat::kRgba8Srgb; }

void appendAlphaRow(const Texture& texture, int row, std::vector<std::uint8_t>& out) {
  const auto width = std::size_t(texture.width);
  for (std::size_t x = 0; x < width; ++x)
    out.push_back(hasAlpha(texture) ? texture.texels[4 * (std::size_t(row) * width + x) + 3] : std::uint8_t(255));
}

}  // namespace lpv
