#include "reference/textures.h"

#include <cstring>
#include <memory>
#include <random>

namespace lpv::reference {
namespace {

Texture emptyOf(int width, int height, TexelFormat format) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.format = format;
  texture.texels.resize(std::size_t(width) * std::size_t(height) * texelBytes(format));
  return texture;
}

}  // namespace

TexturePtr textureOf(int width, int height, const std::function<glm::dvec3(int x, int y)>& value) {
  Texture texture = emptyOf(width, height, TexelFormat::kRgb32F);
  std::size_t next = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::vec3 rgb(value(x, y));
      std::memcpy(&texture.texels[next], &rgb[0], 3 * sizeof(float));
      next += 3 * sizeof(float);
    }
  }
  return std::make_shared<const Texture>(std::move(texture));
}

TexturePtr noise(int width, int height, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(0.0, 1.0);
  return textureOf(width, height, [&](int, int) {
    const double red = value(random);
    const double green = value(random);
    return glm::dvec3(red, green, value(random));
  });
}

TexturePtr srgbTextureOf(int width, int height, const std::function<glm::u8vec3(int x, int y)>& code) {
  Texture texture = emptyOf(width, height, TexelFormat::kRgb8Srgb);
  std::size_t next = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const glm::u8vec3 rgb = code(x, y);
      for (int c = 0; c < 3; ++c) texture.texels[next++] = rgb[c];
    }
  }
  return std::make_shared<const Texture>(std::move(texture));
}

TexturePtr alphaTextureOf(int width, int height, const std::function<std::uint8_t(int x, int y)>& alpha) {
  Texture texture = emptyOf(width, height, TexelFormat::kRgba8Srgb);
  std::size_t next = 0;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < 3; ++c) texture.texels[next++] = 255;
      texture.texels[next++] = alpha(x, y);
    }
  }
  return std::make_shared<const Texture>(std::move(texture));
}

}  // namespace lpv::reference
