#include "scene/texture.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

namespace lpv {
namespace {

using testing::HasSubstr;

Texture textureOf(int width, int height, TexelFormat format) {
  Texture texture;
  texture.width = width;
  texture.height = height;
  texture.format = format;
  texture.texels.resize(std::size_t(width) * std::size_t(height) * texelBytes(format));
  return texture;
}

void expectRefused(const Texture& texture, const std::string& field, const std::string& words) {
  const Status status = checkTexture(texture);
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_EQ(status.field(), field);
  EXPECT_THAT(status.message(), HasSubstr(words));
}

void setFloat(Texture& texture, std::size_t channel, float value) {
  std::memcpy(&texture.texels[channel * sizeof value], &value, sizeof value);
}

void setHalf(Texture& texture, std::size_t channel, std::uint16_t bits) {
  std::memcpy(&texture.texels[channel * sizeof bits], &bits, sizeof bits);
}

TEST(TexelBytes, AreThreeChannels) {
  EXPECT_EQ(texelBytes(TexelFormat::kRgb8Srgb), 3U);
  EXPECT_EQ(texelBytes(TexelFormat::kRgb16F), 6U);
  EXPECT_EQ(texelBytes(TexelFormat::kRgb32F), 12U);
}

TEST(CheckTexture, TakesEveryFormat) {
  for (const TexelFormat f : {TexelFormat::kRgb8Srgb, TexelFormat::kRgb16F, TexelFormat::kRgb32F}) {
    EXPECT_TRUE(checkTexture(textureOf(5, 3, f)).ok());
  }
}

TEST(CheckTexture, RefusesASizeThatIsNotItsBytes) {
  Texture texture = textureOf(4, 4, TexelFormat::kRgb8Srgb);
  texture.texels.pop_back();
  expectRefused(texture, "texels", "47 bytes");
  expectRefused(texture, "texels", "48");
  texture.texels.resize(49);
  expectRefused(texture, "texels", "49");
  texture.texels.clear();
  expectRefused(texture, "texels", "0 bytes");
}

TEST(CheckTexture, RefusesSizesOutOfRangeBeforeMultiplyingThem) {
  Texture texture;
  texture.height = 1;
  expectRefused(texture, "width", "0 texels");
  texture.width = 16385;
  expectRefused(texture, "width", "16385");
  texture.width = 1;
  texture.height = std::numeric_limits<int>::min();
  expectRefused(texture, "height", "16384");
}

// Radiance cannot be negative, NaN or infinite; each channel of each texel is looked at.
TEST(CheckTexture, RefusesFloatTexelsThatAreNoRadiance) {
  for (const float bad : {-1e-6F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    Texture texture = textureOf(3, 2, TexelFormat::kRgb32F);
    setFloat(texture, 17, bad);
    expectRefused(texture, "texels", "texel 5");
  }
  Texture bright = textureOf(3, 2, TexelFormat::kRgb32F);
  setFloat(bright, 0, 1e6F);
  setFloat(bright, 1, -0.0F);
  EXPECT_TRUE(checkTexture(bright).ok());
}

TEST(CheckTexture, RefusesHalfTexelsThatAreNoRadiance) {
  for (const std::uint16_t bad : {0xbc00, 0x7e00, 0x7c00, 0xfc00}) {  // -1, NaN, inf, -inf
    Texture texture = textureOf(2, 2, TexelFormat::kRgb16F);
    setHalf(texture, 4, bad);
    expectRefused(texture, "texels", "texel 1");
  }
  Texture bright = textureOf(2, 2, TexelFormat::kRgb16F);
  setHalf(bright, 11, 0x7bff);  // 65504, the largest
  EXPECT_TRUE(checkTexture(bright).ok());
}

}  // namespace
}  // namespace lpv
