// Illuminance in false colours: what a colour stands for.

#include "encode/false_colour.h"

#include <gtest/gtest.h>

namespace lpv::encode {
namespace {

/// So many pixels of one grey irradiance, W/m^2.
std::vector<float> grey(std::size_t pixels, float value) { return std::vector<float>(3 * pixels, value); }

// Broken by: another luminance or efficacy.
TEST(FalseColour, Lux) {
  EXPECT_NEAR(luxOf({1, 1, 1}), 179.0, 1e-4);
  EXPECT_NEAR(luxOf({0, 1, 0}), 179.0 * 0.7152, 1e-4);
}

// Broken by: the mean or the brightest pixel as the scale's end.
TEST(FalseColour, TheScaleEndsAtARoundNumber) {
  EXPECT_EQ(brightestLux(grey(100, 1.0F)), 200.0);
  EXPECT_EQ(brightestLux(grey(100, 1.2F)), 500.0);
  EXPECT_EQ(brightestLux(grey(100, 3.0F)), 1000.0);
  EXPECT_NEAR(brightestLux(grey(100, 1e-5F)), 2e-3, 1e-12);
  EXPECT_EQ(brightestLux(grey(100, 0.0F)), 1.0);
  std::vector<float> spot = grey(1000, 1.0F);
  for (std::size_t i = 0; i < 9; ++i) spot[i] = 1e6F;  // three pixels beside a lamp
  EXPECT_EQ(brightestLux(spot), 200.0);
}

TEST(FalseColour, RisesFromVioletToYellow) {
  EXPECT_EQ(falseColour(0.0, 100.0), glm::u8vec3(0));
  EXPECT_EQ(falseColour(1.0, 100.0), glm::u8vec3(68, 1, 84));
  EXPECT_EQ(falseColour(0.01, 100.0), glm::u8vec3(68, 1, 84)) << "below the scale";
  EXPECT_EQ(falseColour(100.0, 100.0), glm::u8vec3(253, 231, 37));
  EXPECT_EQ(falseColour(1e9, 100.0), glm::u8vec3(253, 231, 37)) << "above the scale";
  int before = 0;
  for (double lux = 1.0; lux <= 100.0; lux *= 1.1) {
    const int green = falseColour(lux, 100.0).y;
    EXPECT_GE(green, before) << lux;
    before = green;
  }
}

// The legend's bar has the scale's colours; pictures that are too small have none.
// Broken by: a bar that runs the other way.
TEST(FalseColour, Legend) {
  const glm::ivec2 size(320, 200);
  const std::vector<std::uint8_t> picture = falseColours(size, grey(std::size_t(size.x) * std::size_t(size.y), 1.0F));
  const auto at = [&](int x, int y) {
    const std::uint8_t* p = &picture[3 * (std::size_t(y) * std::size_t(size.x) + std::size_t(x))];
    return glm::u8vec3(p[0], p[1], p[2]);
  };
  const glm::u8vec3 all = falseColour(179.0, 200.0);
  EXPECT_EQ(at(300, 20), all);
  int row = 199;
  while (row > 0 && at(16, row) != falseColour(2.0, 200.0)) --row;
  ASSERT_GT(row, 100) << "no bar";
  EXPECT_EQ(at(16 + 179, row), falseColour(200.0, 200.0));
  const std::vector<std::uint8_t> small = falseColours({40, 30}, grey(40 * 30, 1.0F));
  for (std::size_t i = 0; i < small.size(); i += 3)
    EXPECT_EQ(glm::u8vec3(small[i], small[i + 1], small[i + 2]), all) << i;
}

}  // namespace
}  // namespace lpv::encode
