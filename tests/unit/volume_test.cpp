// Irradiance from a volume: the product's lookup against the reference's (MATHS.md 4).
#include "scene/volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/volume.h"

namespace lpv {
namespace {

Grid someGrid(const glm::ivec3& dims) {
  Grid grid;
  grid.origin = {-3.0, 1.0, 20.0};
  grid.cell = 0.4;
  grid.dims = dims;
  return grid;
}

reference::Field randomField(const glm::ivec3& dims, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1.0F, 1.0F);
  reference::Field field(dims);
  for (auto& cell : field.cells) {
    for (reference::Coefficients& c : cell) c = {value(random) + 1.5F, value(random), value(random), value(random)};
  }
  return field;
}

/// Random points in and around the grid with random normals.
template <typename Visit>
void forSomePoints(const Grid& grid, Visit visit) {
  std::mt19937 random(77);
  std::uniform_real_distribution<double> at(-1.2, 1.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 share = glm::dvec3(at(random), at(random), at(random)) + 0.6;
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    visit(grid.worldFromGrid(share * glm::dvec3(grid.dims)), n);
  }
}

TEST(IrradianceSh2, EqualsTheReference) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const sh::Coefficients c(normal(random), normal(random), normal(random), normal(random));
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    EXPECT_NEAR(irradianceSh2(c, n), reference::sh2(c, n), 1e-13);
  }
}

// Red when a weight, the half-cell offset, the clamp or the order of coefficients is off, also for flat grids.
TEST(IrradianceAt, EqualsTheReferenceForEveryLookup) {
  for (const glm::ivec3& dims : {glm::ivec3(5, 4, 6), glm::ivec3(1, 7, 1), glm::ivec3(1)}) {
    const Grid grid = someGrid(dims);
    const reference::Field field = randomField(dims, 4);
    const Volume volume = reference::toVolume(grid, field);
    int valid = 0;
    for (const Lookup how : {Lookup::kSh2, Lookup::kNearest}) {
      forSomePoints(grid, [&](const glm::dvec3& p, const glm::dvec3& n) {
        const Irradiance tested = irradianceAt(volume, how, p, n);
        const auto truth = reference::lookup(grid, field, how, p, n);
        ASSERT_EQ(tested.valid, truth.has_value());
        valid += tested.valid;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(tested.rgb[c], truth.value_or(glm::dvec3(0.0))[c], 1e-13);
      });
    }
    EXPECT_GT(valid, 100);
  }
}

TEST(IrradianceAt, SumsLayersAfterTheLookup) {
  const Grid grid = someGrid(glm::ivec3(3));
  Volume both = reference::toVolume(grid, randomField(grid.dims, 5));
  const Volume second = reference::toVolume(grid, randomField(grid.dims, 6));
  const Volume first = both;
  both.layers.push_back(second.layers[0]);
  forSomePoints(grid, [&](const glm::dvec3& p, const glm::dvec3& n) {
    const glm::dvec3 apart = irradianceAt(first, Lookup::kSh2, p, n).rgb + irradianceAt(second, Lookup::kSh2, p, n).rgb;
    const glm::dvec3 together = irradianceAt(both, Lookup::kSh2, p, n).rgb;
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(together[c], apart[c], 1e-13);
  });
}

TEST(IrradianceAt, IsInvalidBeyondHalfACellAndAtNoPlace) {
  const Grid grid = someGrid(glm::ivec3(4));
  const Volume volume = reference::toVolume(grid, randomField(grid.dims, 7));
  const auto valid = [&](const glm::dvec3& g) {
    return irradianceAt(volume, Lookup::kSh2, grid.worldFromGrid(g), {0, 1, 0}).valid;
  };
  EXPECT_TRUE(valid({-0.499, 2, 2}));
  EXPECT_TRUE(valid({2, 2, 4.499}));
  EXPECT_FALSE(valid({-0.501, 2, 2}));
  EXPECT_FALSE(valid({2, 4.501, 2}));
  EXPECT_FALSE(valid({2, std::nan(""), 2}));
  EXPECT_FALSE(valid({1e300, 2, 2}));
}

TEST(VolumeAt, ReadsTheDocumentedOrder) {
  const Grid grid = someGrid({2, 3, 4});
  VolumeLayer layer;
  for (int i = 0; i < 2 * 3 * 4 * 12; ++i) layer.coefficients.push_back(float(i));
  const double first = double(((3 * 3 + 2) * 2 + 1) * 12 + 4);  // cell (1, 2, 3), colour 1
  EXPECT_EQ(Volume::at(layer, grid, {1, 2, 3}, 1), sh::Coefficients(first, first + 1, first + 2, first + 3));
}

}  // namespace
}  // namespace lpv
