// What voxelization is told about lights, on the CPU alone.

#include "lpv/resources/lights.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "lpv/resources/palette.h"
#include "lpv/voxelize/fixed_point.h"
#include "reference/meshes.h"
#include "scene/sh.h"

namespace lpv {
namespace {

EmittingLight light(const glm::dvec3& radiance) {
  EmittingLight l;
  l.mesh = reference::quad();
  l.radiance = radiance;
  return l;
}

// Broken by: comparing colours instead of their ratios.
TEST(PaletteTest, LightsOfOneChromaticityShareAChannel) {
  const Palette palette = choosePalette({light({1, 2, 4}), light({2, 4, 8}), light({0.1, 0.2, 0.4})});
  EXPECT_EQ(palette.channels, 1);
  EXPECT_EQ(palette.radiance[0], glm::dvec3(2, 4, 8));
  EXPECT_DOUBLE_EQ(palette.weights[0].x, 0.5);
  EXPECT_DOUBLE_EQ(palette.weights[1].x, 1.0);
  EXPECT_DOUBLE_EQ(palette.weights[2].x, 0.05);
}

TEST(PaletteTest, EveryLightsRadianceComesBack) {
  const std::vector<EmittingLight> lights = {light({1, 0, 0}), light({0, 2, 0}), light({3, 3, 0.5}),
                                             light({1e6, 1, 1e-6})};
  for (std::size_t count = 0; count <= lights.size(); ++count) {
    const std::vector<EmittingLight> some(lights.begin(), lights.begin() + std::ptrdiff_t(count));
    const Palette palette = choosePalette(some);
    EXPECT_EQ(palette.channels, (std::array{1, 1, 2, 3, 3})[count]);
    for (std::size_t i = 0; i < count; ++i) {
      glm::dvec3 sum(0.0);
      for (int k = 0; k < palette.channels; ++k) sum += palette.weights[i][k] * palette.radiance[std::size_t(k)];
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(sum[c], some[i].radiance[c], 1e-12 * some[i].radiance[c]);
    }
  }
}

// Broken by: a bound without the rounding's half.
TEST(FixedPointTest, TheLargestSumFitsAndOneBitMoreDoesNot) {
  for (const std::uint64_t lobes : {1ULL, 1000ULL, 33446ULL, 1000000ULL, 4000000ULL}) {
    const Expected<FixedPoint> fixed = fixedPointFor(lobes);
    ASSERT_TRUE(fixed.ok()) << lobes;
    const double word = std::ldexp(1.0, fixed->shift) + 1.0;
    EXPECT_LE(word * double(lobes), 2147483647.0);
    if (fixed->shift < 24) {
      EXPECT_GT((2.0 * word - 1.0) * double(lobes), 2147483647.0);
    }
  }
  EXPECT_EQ(fixedPointFor(33446)->shift, 15);  // MATHS.md 2
}

TEST(FixedPointTest, TooManyTrianglesAreRefused) {
  const Expected<FixedPoint> fixed = fixedPointFor(std::uint64_t(1) << 40);
  ASSERT_FALSE(fixed.ok());
  EXPECT_EQ(fixed.status().code(), Code::kResourceExhausted);
}

// Broken by: floor for the upper end; no clamp.
TEST(CellBoxTest, HoldsWhatLightsTouch) {
  EmittingLight l = light(glm::dvec3(1.0));  // 1 x 1 in z = 0, about the origin
  l.gridFromObject[3] = glm::dvec4(4.0, 4.5, 8.0, 1.0);
  EXPECT_EQ(cellsAround({l}, {8, 8, 8}), (CellBox{{3, 3, 7}, {5, 6, 8}}));
  l.gridFromObject[3].z = 8.1;
  EXPECT_TRUE(cellsAround({l}, {8, 8, 8}).empty());
  EXPECT_TRUE(cellsAround({}, {8, 8, 8}).empty());
}

TEST(CellBoxTest, GrowsByOneCellWithinTheGrid) {
  EXPECT_EQ((CellBox{{0, 3, 7}, {1, 4, 8}}.grown({8, 8, 8})), (CellBox{{0, 2, 6}, {2, 5, 8}}));
  EXPECT_TRUE(CellBox{}.grown({8, 8, 8}).empty());
}

}  // namespace
}  // namespace lpv
