// The coverage grid of visibility_bench: shares that are known.
#include "bench/coverage_grid.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <numbers>

#include "reference/meshes.h"

namespace lpv::bench {
namespace {

/// The quad of 1 x 1 m in z = 0, scaled, turned about y and moved to `at`.
Occluder quadAt(const glm::dvec3& at, const glm::dvec3& scale, double degrees = 0.0) {
  glm::dmat4 m = glm::translate(glm::dmat4(1.0), at);
  m = glm::rotate(m, glm::radians(degrees), glm::dvec3(0, 1, 0));
  return {.mesh = reference::quad(), .worldFromObject = glm::scale(m, scale), .coverage = {}};
}

CoverageGrid gridOf(const std::vector<Occluder>& occluders) {
  return CoverageGrid(occluders, glm::dmat4(1.0), glm::ivec3(4));
}

glm::dvec3 sharesAt(const CoverageGrid& grid, const glm::ivec3& cell) {
  return glm::dvec3(glm::u8vec3(grid.at(cell))) / 255.0;
}

void expectShares(const glm::dvec3& got, const glm::dvec3& want, double tolerance) {
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(got[axis], want[axis], tolerance) << "axis " << axis;
}

constexpr double kStep = 0.5 / 255.0 + 1e-9;  // what rounding to a byte leaves
constexpr double kLine = 1.0 / kCoverageLines;

// Red with rows that are filled to their cell's end.
TEST(CoverageGridTest, ABarOfHalfACellCoversHalfOfIt) {
  const CoverageGrid grid = gridOf({quadAt({1.25, 2.0, 1.5}, {0.5, 4.0, 1.0})});
  for (int y = 0; y < 4; ++y) expectShares(sharesAt(grid, {1, y, 1}), {0.0, 0.0, 0.5}, kStep);
  expectShares(sharesAt(grid, {0, 1, 1}), glm::dvec3(0.0), 0.0);
  expectShares(sharesAt(grid, {2, 1, 1}), glm::dvec3(0.0), 0.0);
  expectShares(sharesAt(grid, {1, 1, 2}), glm::dvec3(0.0), 0.0);
}

// Each cell that the diagonal goes through is covered as seen along x and along z, and not along y.
TEST(CoverageGridTest, ADiagonalQuadCoversAlongBothAxesThatItFaces) {
  const CoverageGrid grid = gridOf({quadAt({2.0, 2.0, 2.0}, {4.0 * std::numbers::sqrt2, 4.0, 1.0}, 45.0)});
  for (int x = 0; x < 4; ++x) expectShares(sharesAt(grid, {x, 1, 3 - x}), {1.0, 0.0, 1.0}, kStep);
  expectShares(sharesAt(grid, {1, 1, 1}), glm::dvec3(0.0), 0.0);
}

// A slope of a third: what is covered along z is shared out over the cells that it passes, along x it is a third.
// Red with the depth of the triangle's first corner instead of each line's.
TEST(CoverageGridTest, SharesOfAFlatSlopeAddUpOverLayers) {
  const double slope = 1.0 / 3.0;
  const double length = 4.0 * std::sqrt(1.0 + slope * slope);
  const double degrees = -glm::degrees(std::atan(slope));
  const CoverageGrid grid = gridOf({quadAt({2.0, 2.0, 1.8}, {length, 4.0, 1.0}, degrees)});
  for (int x = 0; x < 4; ++x) {
    glm::dvec3 sum(0.0);
    for (int z = 0; z < 4; ++z) sum += sharesAt(grid, {x, 2, z});
    expectShares(sum, {slope, 0.0, 1.0}, kLine);
  }
}

// Red where a surface's lines take the place of the others'.
TEST(CoverageGridTest, WhatLiesBehindOneAnotherInACellCoversOnce) {
  const Occluder near = quadAt({1.25, 2.0, 1.25}, {0.5, 4.0, 1.0}), far = quadAt({1.25, 2.0, 1.75}, {0.5, 4.0, 1.0});
  const Occluder beside = quadAt({1.75, 2.0, 1.5}, {0.5, 4.0, 1.0});
  expectShares(sharesAt(gridOf({near, far}), {1, 1, 1}), {0.0, 0.0, 0.5}, kStep);
  expectShares(sharesAt(gridOf({near, beside}), {1, 1, 1}), {0.0, 0.0, 1.0}, kStep);
}

// A ball of triangles that are smaller than cells: every line through it meets its near side and its far side.
// Red with triangles that are taken from one side alone.
TEST(CoverageGridTest, TrianglesThatShareEdgesLeaveNoGap) {
  const glm::dmat4 m = glm::scale(glm::translate(glm::dmat4(1.0), glm::dvec3(2.53, 2.47, 2.51)), glm::dvec3(3.6));
  const MeshCoverage ball(*reference::bumpySphere(20000), m, glm::ivec3(5));
  for (int axis = 0; axis < 3; ++axis) {
    for (const int side : {0, 3}) {
      CoveredLines half;
      for (int k = side; k < side + 2; ++k) {
        glm::ivec3 cell(2);
        cell[axis] = k;
        if (const CoveredLines* lines = ball.at(cell)) half |= *lines;
      }
      EXPECT_THAT(half.rows[std::size_t(axis)], testing::Each(0xffff)) << "axis " << axis << ", from layer " << side;
    }
  }
}

// 32 triangles whose edges lie on lines. Red where rows leave out their ends.
TEST(CoverageGridTest, LinesOnEdgesAreCovered) {
  const double half = 0.5 * kLine;
  const Occluder tiles = {.mesh = reference::quadOf(4),
                          .worldFromObject = quadAt({2.0 + half, 2.0 + half, 1.5}, {4.0, 4.0, 1.0}).worldFromObject,
                          .coverage = {}};
  const CoverageGrid grid = gridOf({tiles});
  for (int x = 1; x < 4; ++x)
    for (int y = 1; y < 4; ++y) expectShares(sharesAt(grid, {x, y, 1}), {0.0, 0.0, 1.0}, 0.0);
}

// Half-open as the volume's grid: the upper cell has what lies in a face, and the last one the outer face.
TEST(CoverageGridTest, AFaceBelongsToTheUpperCell) {
  const CoverageGrid grid =
      gridOf({quadAt({2.0, 2.0, 2.0}, {4.0, 4.0, 1.0}), quadAt({2.0, 2.0, 4.0}, {4.0, 4.0, 1.0})});
  expectShares(sharesAt(grid, {1, 1, 1}), glm::dvec3(0.0), 0.0);
  expectShares(sharesAt(grid, {1, 1, 2}), {0.0, 0.0, 1.0}, 0.0);
  expectShares(sharesAt(grid, {3, 0, 3}), {0.0, 0.0, 1.0}, 0.0);
}

// Red where the cells that it has left are not counted anew.
TEST(CoverageGridTest, AMoveIsTheSameAsAGridMadeAnew) {
  const std::vector<Occluder> before = {quadAt({2.0, 2.0, 1.5}, {3.0, 3.0, 1.0}, 20.0),
                                        quadAt({1.2, 2.0, 1.6}, {1.0, 2.0, 1.0}, -30.0)};
  std::vector<Occluder> after = before;
  after[1] = quadAt({2.9, 1.4, 2.2}, {1.0, 2.0, 1.0}, 50.0);
  CoverageGrid moved = gridOf(before);
  const std::vector<glm::u8vec4> old = moved.shares();
  const CellBox changed = moved.move(1, after[1]);
  const CoverageGrid anew = gridOf(after);
  EXPECT_THAT(moved.shares(), testing::ContainerEq(anew.shares()));
  for (int i = 0; i < 64; ++i) {
    const glm::ivec3 cell(i % 4, i / 4 % 4, i / 16);
    EXPECT_TRUE(changed.holds(cell) || old[std::size_t(i)] == moved.shares()[std::size_t(i)]) << i;
  }
  EXPECT_NE(old, moved.shares());
}

}  // namespace
}  // namespace lpv::bench
