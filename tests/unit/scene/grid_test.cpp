// Grids: cubic cells, indices, fitting, and every refused size (MATHS.md 1).
#include "scene/grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

namespace lpv {
namespace {

using testing::HasSubstr;

constexpr double kInfinity = std::numeric_limits<double>::infinity();
const Bounds kRoom{{-2.0, 0.0, -1.0}, {2.0, 2.6, 1.5}};  // 4 x 2.6 x 2.5 m

GridOptions longest(int cells) {
  GridOptions options;
  options.longest = cells;
  return options;
}

GridOptions dims(const glm::ivec3& cells) {
  GridOptions options;
  options.dims = cells;
  return options;
}

void expectRefused(const Expected<Grid>& grid, const std::string& field, const std::string& value) {
  ASSERT_FALSE(grid.ok());
  EXPECT_EQ(grid.status().code(), Code::kInvalidArgument);
  EXPECT_EQ(grid.status().field(), field);
  EXPECT_THAT(grid.status().message(), HasSubstr(value));
}

TEST(MakeGrid, RoundsTheOtherEdgesUpAndMovesTheMaximumOut) {
  const Expected<Grid> grid = makeGrid(longest(32), kRoom);
  ASSERT_TRUE(grid.ok()) << grid.status().message();
  EXPECT_DOUBLE_EQ(grid->cell, 0.125);
  EXPECT_EQ(grid->dims, glm::ivec3(32, 21, 20));  // 2.6 / .125 = 20.8, 2.5 / .125 = 20 exactly
  EXPECT_EQ(grid->origin, kRoom.min);
  EXPECT_DOUBLE_EQ(grid->bounds().max.y, 21 * 0.125);
  EXPECT_DOUBLE_EQ(grid->bounds().max.z, 1.5);
}

// .3 / .1 is 2.9999999999999996 or 3.0000000000000004 depending on how it is written: neither may give another cell.
TEST(MakeGrid, WholeRatiosDoNotGainACellByRounding) {
  for (int n = 1; n <= kMaxCellsPerAxis; ++n) {
    const Expected<Grid> grid = makeGrid(longest(n), {{0.1, 0.2, 0.3}, {0.1 + 0.1 * n, 0.2 + 0.1 * n, 0.4}});
    ASSERT_TRUE(grid.ok());
    EXPECT_EQ(grid->dims, glm::ivec3(n, n, 1)) << n;
  }
}

TEST(MakeGrid, WithDimsTheCellIsTheLargestNeeded) {
  const Expected<Grid> grid = makeGrid(dims({16, 26, 10}), kRoom);
  ASSERT_TRUE(grid.ok());
  EXPECT_EQ(grid->dims, glm::ivec3(16, 26, 10));
  EXPECT_DOUBLE_EQ(grid->cell, 0.25);  // 4/16 and 2.5/10; 2.6/26 would be .1
  const Bounds b = grid->bounds();
  for (int k = 0; k < 3; ++k) EXPECT_GE(b.max[k], kRoom.max[k] - 1e-12);
}

TEST(MakeGrid, DefaultsTo32AlongTheLongestEdge) {
  const Expected<Grid> grid = makeGrid({}, kRoom);
  ASSERT_TRUE(grid.ok());
  EXPECT_EQ(grid->dims.x, kDefaultCellsOfLongestEdge);
}

TEST(MakeGrid, TakesAFlatBox) {
  const Expected<Grid> grid = makeGrid(longest(8), {{0, 0, 0}, {2, 1, 0}});
  ASSERT_TRUE(grid.ok());
  EXPECT_EQ(grid->dims, glm::ivec3(8, 4, 1));
}

TEST(MakeGrid, RefusesCellsOutOfRangeNamingValueAndLimit) {
  expectRefused(makeGrid(longest(4096), kRoom), "longest", "4096");
  expectRefused(makeGrid(longest(129), kRoom), "longest", "128");
  expectRefused(makeGrid(longest(-1), kRoom), "longest", "-1");
  expectRefused(makeGrid(dims({32, 0, 32}), kRoom), "dims.y", "0");
  expectRefused(makeGrid(dims({32, 32, 4096}), kRoom), "dims.z", "4096");
  expectRefused(makeGrid(dims({-3, 32, 32}), kRoom), "dims.x", "-3");
  EXPECT_TRUE(makeGrid(longest(kMaxCellsPerAxis), kRoom).ok());
  EXPECT_TRUE(makeGrid(longest(1), kRoom).ok());
}

TEST(MakeGrid, RefusesBoundsThatAreNone) {
  expectRefused(makeGrid(longest(8), {{0, 2, 0}, {1, 1, 1}}), "bounds", "inside out");
  expectRefused(makeGrid(longest(8), {{0, std::nan(""), 0}, {1, 1, 1}}), "bounds", "finite");
  expectRefused(makeGrid(longest(8), {{0, 0, 0}, {1, kInfinity, 1}}), "bounds", "finite");
  expectRefused(makeGrid(longest(8), {{1, 1, 1}, {1, 1, 1}}), "bounds", "smaller");
  expectRefused(makeGrid(longest(8), {{0, 0, 0}, {1e12, 1, 1}}), "bounds", "beyond");
  EXPECT_FALSE(makeGrid(longest(8), Bounds()).ok());
}

// Red when the margin is taken on one side only or counted in metres.
TEST(FitGrid, LeavesTwoCellsOnEachSide) {
  const Expected<Grid> grid = fitGrid(longest(36), kRoom);
  ASSERT_TRUE(grid.ok());
  EXPECT_DOUBLE_EQ(grid->cell, 4.0 / 32.0);
  EXPECT_EQ(grid->dims.x, 36);
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(grid->bounds().max[k] - kRoom.max[k], kFitMarginCells * grid->cell - 1e-12);
    EXPECT_GE(kRoom.min[k] - grid->bounds().min[k], kFitMarginCells * grid->cell - 1e-12);
  }
  const Expected<Grid> byDims = fitGrid(dims({20, 30, 40}), kRoom);
  ASSERT_TRUE(byDims.ok());
  EXPECT_EQ(byDims->dims, glm::ivec3(20, 30, 40));
  for (int k = 0; k < 3; ++k) {
    EXPECT_GE(byDims->bounds().max[k] - kRoom.max[k], kFitMarginCells * byDims->cell - 1e-12);
    EXPECT_GE(kRoom.min[k] - byDims->bounds().min[k], kFitMarginCells * byDims->cell - 1e-12);
  }
}

TEST(FitGrid, ContainsTheContentAtEverySize) {
  for (int n = 1; n <= kMaxCellsPerAxis; ++n) {
    const Expected<Grid> grid = fitGrid(longest(n), kRoom);
    ASSERT_TRUE(grid.ok()) << n;
    for (int k = 0; k < 3; ++k) {
      EXPECT_LE(grid->dims[k], n);
      EXPECT_GE(grid->bounds().max[k], kRoom.max[k] - 1e-9) << n;
      EXPECT_LE(grid->bounds().min[k], kRoom.min[k] + 1e-9) << n;
    }
  }
}

TEST(FitGrid, GivesNothingAndPointsAOneMetreBox) {
  for (const Bounds& content : {Bounds(), Bounds{{3, 3, 3}, {3, 3, 3}}}) {
    const Expected<Grid> grid = fitGrid(longest(12), content);
    ASSERT_TRUE(grid.ok());
    EXPECT_DOUBLE_EQ(grid->cell, 1.0 / 8.0);
    const glm::dvec3 centre = content.empty() ? glm::dvec3(0.0) : content.min;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(grid->bounds().centre()[k], centre[k], 1e-12);
  }
  EXPECT_FALSE(fitGrid(longest(4096), kRoom).ok());
  EXPECT_FALSE(fitGrid(dims({1, 2, 0}), kRoom).ok());
}

TEST(Grid, IndicesRunXFirstThenYThenZ) {
  Grid grid;
  grid.dims = {3, 4, 5};
  EXPECT_EQ(grid.cells(), 60U);
  EXPECT_EQ(grid.index({0, 0, 0}), 0U);
  EXPECT_EQ(grid.index({1, 0, 0}), 1U);
  EXPECT_EQ(grid.index({0, 1, 0}), 3U);
  EXPECT_EQ(grid.index({0, 0, 1}), 12U);
  EXPECT_EQ(grid.index({2, 3, 4}), 59U);
}

TEST(Grid, SpacesAreInversesOfEachOther) {
  Grid grid;
  grid.origin = {10.0, -20.0, 5.0};
  grid.cell = 0.3;
  grid.dims = {4, 4, 4};
  const glm::dvec3 p(10.7, -19.2, 5.1);
  const glm::dvec3 g = grid.gridFromWorld(p);
  EXPECT_NEAR(g.x, 0.7 / 0.3, 1e-13);
  const glm::dvec3 byMatrix(grid.gridFromWorldMatrix() * glm::dvec4(p, 1.0));
  const glm::dvec3 back = grid.worldFromGrid(g);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(back[k], p[k], 1e-13);
    EXPECT_NEAR(byMatrix[k], g[k], 1e-12);
  }
  EXPECT_NEAR(grid.cellCentre({1, 0, 3}).x, 10.45, 1e-13);
  EXPECT_NEAR(grid.cellCentre({1, 0, 3}).z, 6.05, 1e-13);
}

TEST(Bounds, AddAndTransform) {
  Bounds b;
  EXPECT_TRUE(b.empty());
  b.add(Bounds());
  EXPECT_TRUE(b.empty());
  b.add(glm::dvec3(1, 2, 3));
  b.add(glm::dvec3(-1, 0, 5));
  EXPECT_EQ(b.extent(), glm::dvec3(2, 2, 2));
  EXPECT_EQ(b.centre(), glm::dvec3(0, 1, 4));
  glm::dmat4 m(1.0);
  m[0] = {0, -2, 0, 0};  // x becomes -2 y
  m[1] = {1, 0, 0, 0};   // y becomes x
  m[3] = {10, 0, 0, 1};
  const Bounds moved = b.transformed(m);
  EXPECT_EQ(moved.min, glm::dvec3(10, -2, 3));
  EXPECT_EQ(moved.max, glm::dvec3(12, 2, 5));
  EXPECT_TRUE(Bounds().transformed(m).empty());
}

}  // namespace
}  // namespace lpv
