// Closed forms against the value of MATHS.md 5, against quadrature, and against each other.
#include "reference/ground_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

using Corners = std::array<glm::dvec3, 3>;

Grid anyGrid() {
  Grid grid;
  grid.origin = glm::dvec3(-2.0);
  grid.cell = 0.25;
  grid.dims = glm::ivec3(16);
  return grid;
}

std::vector<Emitter> emittersFor(const MeshPtr& mesh, bool twoSided = false) {
  return emittersOf(anyGrid(), *mesh, glm::dmat4(1.0), glm::dvec3(1.0), twoSided).triangles;
}

/// Midpoint rule over the triangle in n^2 pieces: E = Int L cos cos / r^2 dA with L = 1, front only.
double irradianceBySampling(const Corners& c, const glm::dvec3& x, const glm::dvec3& n, int pieces) {
  const glm::dvec3 area = 0.5 * glm::cross(c[1] - c[0], c[2] - c[0]);
  double sum = 0.0;
  for (int i = 0; i < pieces; ++i) {
    for (int j = 0; j < 2 * i + 1; ++j) {
      const double third = (j % 2 == 0) ? 1.0 / 3.0 : 2.0 / 3.0;  // pieces point either way
      const double a = (i + 1.0 - third) / pieces;                // share away from corner 0
      const int column = j / 2;
      const double b = (column + third) / pieces;                  // of it, towards corner 2
      const glm::dvec3 y = c[0] + (a - b) * (c[1] - c[0]) + b * (c[2] - c[0]);
      const glm::dvec3 d = y - x;
      const double r2 = glm::dot(d, d);
      sum += std::max(0.0, glm::dot(n, d)) * std::max(0.0, -glm::dot(area, d)) / (r2 * r2);
    }
  }
  return sum / (double(pieces) * pieces);
}

TEST(GroundTruth, UnitSquareAtDistanceOne) {
  const std::vector<Emitter> square = emittersFor(quad());
  const glm::dvec3 e = irradianceOf(square, {0, 0, 1}, {0, 0, -1});
  EXPECT_NEAR(e.x, 0.7522746884541, 5e-14);  // MATHS.md 5 prints 13 digits
  // The same from four corner view factors of a parallel element, A / sqrt(1 + A^2) atan(A / sqrt(1 + A^2)) each.
  const double a = 0.5;
  const double side = std::sqrt(1.0 + a * a);
  EXPECT_NEAR(e.x, 4.0 * (a / side) * std::atan(a / side), 1e-15);
}

TEST(GroundTruth, BehindAOneSidedLightIsDark) {
  const glm::dvec3 x(0.1, 0.2, -1.0);
  EXPECT_EQ(irradianceOf(emittersFor(quad()), x, {0, 0, 1}), glm::dvec3(0.0));
  EXPECT_EQ(incidentSh(emittersFor(quad()), x)[0], Coefficients(0.0));
  const glm::dvec3 mirrored(0.1, 0.2, 1.0);
  const std::vector<Emitter> both = emittersFor(quad(), true);
  EXPECT_NEAR(irradianceOf(both, x, {0, 0, 1}).x, irradianceOf(both, mirrored, {0, 0, -1}).x, 1e-15);
}

// Red when the horizon is not clipped: the second normal has half of the light below it.
TEST(GroundTruth, EqualsSamplingAlsoAcrossTheHorizon) {
  const Corners c = {glm::dvec3(0.2, -0.4, 0.1), glm::dvec3(1.1, 0.3, -0.2), glm::dvec3(-0.1, 0.9, 0.4)};
  const glm::dvec3 x(0.9, 0.5, 1.2);
  ASSERT_GT(triangleMoments(c, x).fluence, 0.0);
  for (const glm::dvec3& n : {glm::dvec3(0, 0, -1), glm::normalize(glm::dvec3(-0.2, 1, -0.3))}) {
    const double sampled = irradianceBySampling(c, x, n, 600);
    EXPECT_NEAR(triangleIrradiance(c, x, n) / sampled, 1.0, 2e-5);  // midpoint rule and the kink at the horizon
  }
}

TEST(GroundTruth, VectorIrradianceIsIrradianceAboveTheHorizon) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> at(-1.0, 1.0);
  for (int i = 0; i < 200; ++i) {
    const Corners c = {glm::dvec3(at(random), at(random), 0.2 * at(random)),
                       glm::dvec3(at(random), at(random), 0.2 * at(random)),
                       glm::dvec3(at(random), at(random), 0.2 * at(random))};
    const glm::dvec3 x(at(random), at(random), 1.0);
    const glm::dvec3 n(0, 0, -1);  // everything is below z = .2: above this horizon
    const Moments m = triangleMoments(c, x);
    EXPECT_NEAR(triangleIrradiance(c, x, n), glm::dot(m.vectorIrradiance, n), 1e-12);
    EXPECT_LE(glm::length(m.vectorIrradiance), m.fluence * (1.0 + 1e-12) + 1e-15);
  }
}

// A closed emitter around the receiver: fluence 4 pi, no direction, irradiance pi.
TEST(GroundTruth, InsideAFurnaceEverythingIsPi) {
  const std::vector<Emitter> furnace = emittersFor(box(glm::dvec3(-1), glm::dvec3(1, 2, 1.5), true));
  const glm::dvec3 x(0.3, -0.2, 0.6);
  const Coefficients c = incidentSh(furnace, x)[1];
  EXPECT_NEAR(fluenceOf(c), 4.0 * pi(), 1e-12);
  EXPECT_NEAR(glm::length(vectorIrradianceOf(c)), 0.0, 1e-12);
  EXPECT_NEAR(irradianceOf(furnace, x, glm::normalize(glm::dvec3(1, 2, -3))).y, pi(), 1e-12);
}

TEST(GroundTruth, IncidentShIsTheProjectionOfTheRadianceSeen) {
  // A sphere of radius R at distance r is a disc of half-angle asin(R/r): fluence 2 pi (1 - cos), |D| = pi sin^2.
  // 2 x 80 x 79 triangles are inside the sphere by up to 1 - cos(pi/80) = 8e-4 of the radius.
  const std::vector<Emitter> ball = emittersFor(sphereOf(80, 80, false));
  const glm::dvec3 x(0.3, -1.1, 1.6);
  const double sine = 0.5 / glm::length(x);
  const Coefficients c = incidentSh(ball, x)[2];
  EXPECT_NEAR(fluenceOf(c) / (2.0 * pi() * (1.0 - std::sqrt(1.0 - sine * sine))), 1.0, 2e-3);
  const glm::dvec3 d = vectorIrradianceOf(c) / (pi() * sine * sine);
  EXPECT_NEAR(glm::length(d + glm::normalize(x)), 0.0, 2e-3);
}

TEST(GroundTruth, TessellationDoesNotMatter) {
  const glm::dvec3 x(0.4, 0.1, 0.3);
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.5, 0.1, -1.0));
  const double whole = irradianceOf(emittersFor(quad()), x, n).x;
  EXPECT_NEAR(irradianceOf(emittersFor(quadOf(20)), x, n).x, whole, 1e-9);  // positions are floats
}

}  // namespace
}  // namespace lpv::reference
