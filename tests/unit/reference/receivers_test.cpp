// The points and measures by which irradiance is compared.
#include "reference/receivers.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/meshes.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

Grid longGrid() {
  Grid grid;
  grid.origin = {-1.0, 2.0, 0.0};
  grid.cell = 0.5;
  grid.dims = {8, 10, 12};
  return grid;
}

// Broken by: normals outwards; the walls of one axis at shares of another's edge.
TEST(WallReceivers, LieOnSixWallsAndLookInwards) {
  const Grid grid = longGrid();
  const std::vector<Receiver> points = wallReceivers(grid);
  ASSERT_EQ(points.size(), 864U);
  const glm::dvec3 edge = glm::dvec3(grid.dims) * grid.cell;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const int axis = int(i) / 288;
    const glm::dvec3 share = (points[i].position - grid.origin) / edge;
    const double inwards = i / 144 % 2 ? -1.0 : 1.0;
    EXPECT_NEAR(share[axis], 0.5 - 0.4 * inwards, 1e-12);
    EXPECT_EQ(points[i].normal[axis], inwards);
    for (int k = 0; k < 3; ++k) EXPECT_TRUE(share[k] > 0.1 - 1e-12 && share[k] < 0.9 + 1e-12);
  }
}

// Broken by: half a cell instead of two; distances to planes or to endless edges.
TEST(ObjectReceivers, StandAwayFromEveryEmitterAndAreTheSameEveryTime) {
  const Grid grid = longGrid();
  glm::dmat4 m(1.0);
  m[3] = {1.0, 4.5, 3.0, 1.0};
  const std::vector<Emitter> light = emittersOf(grid, *sphereOf(12, 8), m, glm::dvec3(1.0), false).triangles;
  const std::vector<Receiver> points = objectReceivers(grid, light, 500);
  const std::vector<Receiver> again = objectReceivers(grid, light, 500);
  double nearest = 1e9;
  for (std::size_t i = 0; i < points.size(); ++i) {
    // Outside, the sphere of radius .5 is at most 1 - cos(pi/8) of it further away than it looks.
    const double away = glm::length(points[i].position - glm::dvec3(m[3])) - 0.5;
    nearest = std::min(nearest, away);
    EXPECT_EQ(points[i].position, again[i].position);
    EXPECT_NEAR(glm::length(points[i].normal), 1.0, 1e-12);
  }
  EXPECT_GE(nearest, 0.95);
  EXPECT_LE(nearest, 1.1);
}

// Broken by: the plane's distance; edges without ends.
TEST(DistanceToTriangle, IsToTheFaceAnEdgeOrACorner) {
  const std::array<glm::dvec3, 3> t = {glm::dvec3(0, 0, 0), glm::dvec3(2, 0, 0), glm::dvec3(0, 2, 0)};
  EXPECT_NEAR(distanceToTriangle({0.5, 0.5, -3}, t), 3.0, 1e-15);
  EXPECT_NEAR(distanceToTriangle({1, -3, 4}, t), 5.0, 1e-15);
  EXPECT_NEAR(distanceToTriangle({2, 2, 0}, t), std::sqrt(2.0), 1e-15);
  EXPECT_NEAR(distanceToTriangle({-1, -2, 2}, t), 3.0, 1e-15);
}

// Broken by: the worst not as a share; NaN ignored.
TEST(ReceiverErrors, AreTheThreeOfTheMetrics) {
  const std::vector<glm::dvec3> truth = {glm::dvec3(3, 0, 0), glm::dvec3(0, 4, 0)};
  const Errors same = errors(truth, truth);
  EXPECT_EQ(same.raw, 0.0);
  EXPECT_EQ(same.worst, 0.0);
  const Errors twice = errors({glm::dvec3(6, 0, 0), glm::dvec3(0, 8, 0)}, truth);
  EXPECT_NEAR(twice.raw, 1.0, 1e-15);
  EXPECT_NEAR(twice.shape, 0.0, 1e-15);
  EXPECT_NEAR(twice.worst, 1.0, 1e-15);
  const Errors one = errors({glm::dvec3(3, 0, 0), glm::dvec3(0, 3, 0)}, truth);
  EXPECT_NEAR(one.raw, 0.2, 1e-15);
  EXPECT_NEAR(one.worst, 0.25, 1e-15);
  EXPECT_TRUE(std::isinf(errors({glm::dvec3(std::nan("")), truth[1]}, truth).worst));
}

}  // namespace
}  // namespace lpv::reference
