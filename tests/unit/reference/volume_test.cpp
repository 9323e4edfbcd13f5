// From propagated flux to irradiance (MATHS.md 1, 3a, 4).
#include "reference/volume.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

/// SH of incident radiance with the moments given.
Coefficients withMoments(double phi, const glm::dvec3& d) {
  return basis(glm::dvec3(1.0)) * Coefficients(phi, d.y, d.z, d.x);
}

Grid smallGrid() {
  Grid grid;
  grid.origin = {1.0, 2.0, 3.0};
  grid.cell = 0.5;
  grid.dims = {4, 5, 6};
  return grid;
}

/// Irradiance of a uniform cap of half-angle a and radiance 1 about c: midpoints of equal solid angle over the cap.
double irradianceOfCap(const glm::dvec3& c, double a, const glm::dvec3& n) {
  constexpr int kSteps = 400;
  const glm::dvec3 t = glm::normalize(glm::cross(c, std::abs(c.x) < 0.5 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0)));
  const glm::dvec3 b = glm::cross(c, t);
  double sum = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double cosine = 1.0 - (1.0 - std::cos(a)) * (i + 0.5) / kSteps;
    const double sine = std::sqrt(1.0 - cosine * cosine);
    for (int j = 0; j < kSteps; ++j) {
      const double azimuth = 2.0 * pi() * (j + 0.5) / kSteps;
      const glm::dvec3 w = sine * (std::cos(azimuth) * t + std::sin(azimuth) * b) + cosine * c;
      sum += std::max(0.0, glm::dot(n, w));
    }
  }
  return sum * 2.0 * pi() * (1.0 - std::cos(a)) / (double(kSteps) * kSteps);
}

TEST(Moments, AreIntegralsOfTheRadianceThatTheCoefficientsStandFor) {
  const Coefficients c(1.2, -0.3, 0.7, 0.4);
  EXPECT_NEAR(fluenceOf(c), integrate([&](const glm::dvec3& w) { return evaluate(c, w); }), 1e-12);
  const glm::dvec3 d = vectorIrradianceOf(c);
  for (int k = 0; k < 3; ++k) {
    EXPECT_NEAR(d[k], integrate([&](const glm::dvec3& w) { return evaluate(c, w) * w[k]; }), 1e-12);
  }
}

// Red when band 1 keeps the sign of travel, or when 1.5 s^2 is forgotten.
TEST(Product, ScalesAndTurnsBandOneRound) {
  Field accumulated(glm::ivec3(1));
  accumulated.cells[0] = {Coefficients(3.0, 0.1, -0.2, 0.3), Coefficients(6.0, 0, 0, 0), Coefficients(0.0)};
  const Product product = productOf(accumulated, 2.0);
  const Coefficients c = product.incident.cells[0][0];
  EXPECT_NEAR(c.x, 0.5, 1e-15);
  EXPECT_NEAR(c.y, -0.1 / 6.0, 1e-15);
  EXPECT_NEAR(c.z, 0.2 / 6.0, 1e-15);
  EXPECT_NEAR(c.w, -0.3 / 6.0, 1e-15);
  EXPECT_EQ(product.clampedCells, 0U);
}

TEST(Product, CutsBackToWhatLightCanBeAndCountsCells) {
  Field accumulated({4, 1, 1});
  accumulated.cells[0] = {Coefficients(-1.0, 0.1, 0, 0), Coefficients(-1.0, 0, 0, 0), Coefficients(1.0, 0, 0, 0)};
  accumulated.cells[1] = {Coefficients(1.0, 3.0, 0, 4.0), Coefficients(1.0, 0, 0, 0), Coefficients(1.0, 0, 0, 0)};
  accumulated.cells[2].fill({1.0, 0.5, 0.0, 0.0});
  const Product product = productOf(accumulated, 1.0);
  EXPECT_EQ(product.clampedCells, 2U);
  EXPECT_EQ(product.incident.cells[0][0], Coefficients(0.0));
  const Coefficients cut = product.incident.cells[1][0];
  EXPECT_NEAR(glm::length(vectorIrradianceOf(cut)), fluenceOf(cut), 1e-14);
  EXPECT_NEAR(vectorIrradianceOf(cut).x / vectorIrradianceOf(cut).y, 4.0 / 3.0, 1e-14);  // the direction stays
}

// Lambert for a small source above the horizon: E = D.n exactly where phi = |D|; SH2 gives (1/4 + ct/2) instead.
TEST(Sh2, IsTheTwoBandConvolutionWithTheClampedCosine) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 50; ++i) {
    const Coefficients c(2.0, 0.2 * normal(random), 0.2 * normal(random), 0.2 * normal(random));
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    const auto received = [&](const glm::dvec3& w) { return evaluate(c, w) * std::max(0.0, glm::dot(n, w)); };
    const double exact = integrate(received, n);
    EXPECT_NEAR(sh2(c, n), exact, 1e-12);
  }
  EXPECT_EQ(sh2(withMoments(1.0, {0, 0, 1}), {0, 0, -1}), 0.0);  // 1/4 - 1/2 is cut at 0
}

TEST(Cap, OfAUniformCapIsItsIrradianceInEveryPose) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.2, 0.9, -0.4));
  const glm::dvec3 t = glm::normalize(glm::cross(n, glm::dvec3(1, 0, 0)));
  for (const double halfAngle : {0.15, 0.6, 1.2}) {
    const double phi = 2.0 * pi() * (1.0 - std::cos(halfAngle));
    const double d = pi() * std::sin(halfAngle) * std::sin(halfAngle);
    for (const double tilt : {0.0, 0.5, 1.3, 1.6, 2.0, 3.0}) {
      const glm::dvec3 c = std::cos(tilt) * n + std::sin(tilt) * t;
      const double truth = irradianceOfCap(c, halfAngle, n);
      // The midpoint rule's error: second order, but for the kink at the horizon.
      EXPECT_NEAR(cap(phi, d * c, n), truth, 1e-5 * d) << "half-angle " << halfAngle << ", tilt " << tilt;
    }
  }
}

// Below rho = 1/2 no cap has the moments: a hemisphere about D, and the rest from everywhere.
TEST(Cap, OfADimlyDirectedFieldIsAHemisphereAndTheRest) {
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.5, -0.1, 0.3));
  for (const double rho : {0.05, 0.3, 0.45, 0.4999}) {
    for (const glm::dvec3& c : {n, -n, glm::normalize(glm::dvec3(-1, 0.2, 0.7))}) {
      const double hemisphere = rho / pi() * irradianceOfCap(c, 0.5 * pi(), n);
      const double rest = (1.0 - 2.0 * rho) / 4.0;
      EXPECT_NEAR(cap(1.0, rho * c, n), hemisphere + rest, 1e-5) << "rho " << rho;
    }
  }
}

TEST(Cap, IsExactForASquareAboveTheHorizon) {
  Grid grid = smallGrid();
  const std::vector<Emitter> square = emittersOf(grid, *quad(), glm::dmat4(1.0), glm::dvec3(1.0), false).triangles;
  const glm::dvec3 x(0.1, 0.3, 1.5);
  const glm::dvec3 n = glm::normalize(glm::dvec3(0.1, 0.1, -1.0));
  EXPECT_NEAR(cap(incidentSh(square, x)[0], n), irradianceOf(square, x, n).x, 1e-12);
}

// 6.4: any input gives a finite answer that is not negative.
TEST(Cap, IsFiniteAndNotNegativeAtTheEdges) {
  const glm::dvec3 z(0, 0, 1);
  EXPECT_EQ(cap(0.0, glm::dvec3(0.0), z), 0.0);
  EXPECT_EQ(cap(-1.0, z, z), 0.0);
  EXPECT_EQ(cap(std::numeric_limits<double>::quiet_NaN(), z, z), 0.0);
  EXPECT_NEAR(cap(4.0, glm::dvec3(0.0), z), 1.0, 1e-15);
  for (int i = 0; i <= 200; ++i) {
    const double rho = i / 160.0;  // up to 1.25, as half floats can say
    for (int j = 0; j <= 200; ++j) {
      const double tilt = pi() * j / 200.0;
      const glm::dvec3 d = rho * glm::dvec3(std::sin(tilt), 0.0, std::cos(tilt));
      const double e = cap(1.0, d, z);
      ASSERT_TRUE(std::isfinite(e) && e >= 0.0) << "rho " << rho << ", tilt " << tilt << ": " << e;
      ASSERT_LE(e, std::max(1.0, rho)) << "rho " << rho << ", tilt " << tilt;
    }
  }
}

TEST(Cap, HasNoJumpBetweenItsBranches) {
  const glm::dvec3 z(0, 0, 1);
  for (int j = 0; j <= 100; ++j) {
    const double tilt = pi() * j / 100.0;
    const glm::dvec3 w(std::sin(tilt), 0.0, std::cos(tilt));
    for (const double rho : {0.5, 1.0 - 2.5e-7}) {  // hemisphere to cap; cap to point (S2 = 1e-6)
      EXPECT_NEAR(cap(1.0, (rho - 1e-9) * w, z), cap(1.0, (rho + 1e-9) * w, z), 1e-3);
    }
  }
}

TEST(Trilinear, ReproducesLinearFieldsAndClampsOutside) {
  const Grid grid = smallGrid();
  Field field(grid.dims);
  const auto value = [](const glm::dvec3& p) { return 1.0 + 2.0 * p.x - 3.0 * p.y + 0.5 * p.z; };
  forEachCell(grid.dims, [&](const glm::ivec3& c) { field.at(c)[1] = Coefficients(value(grid.cellCentre(c))); });
  const glm::dvec3 inside(1.9, 3.1, 4.4);
  EXPECT_NEAR((*trilinear(grid, field, inside))[1].z, value(inside), 1e-13);
  const glm::dvec3 below = {0.8, 3.1, 4.4};  // within half a cell (.25 m) outside x = 1
  EXPECT_NEAR((*trilinear(grid, field, below))[1].x, value({1.25, 3.1, 4.4}), 1e-13);
  EXPECT_FALSE(trilinear(grid, field, {0.7499, 3.1, 4.4}));
  EXPECT_FALSE(trilinear(grid, field, {1.9, 3.1, 6.2501}));
  EXPECT_FALSE(trilinear(grid, field, {std::nan(""), 3.1, 4.4}));
  EXPECT_EQ((*nearest(grid, field, {1.01, 2.01, 3.01}))[1], field.at({0, 0, 0})[1]);
  EXPECT_EQ((*nearest(grid, field, {3.2, 4.6, 6.1}))[1], field.at({3, 4, 5})[1]);
}

TEST(Volumes, AndFieldsAreTheSameNumbersInTheSameOrder) {
  const Grid grid = smallGrid();
  Field field(grid.dims);
  double next = 0.0;
  for (auto& cell : field.cells) {
    for (Coefficients& c : cell) {
      c = next + Coefficients(1, 2, 3, 4);
      next += 4;
    }
  }
  const Field back = fieldOf(toVolume(grid, field));
  EXPECT_EQ(back.dims, field.dims);
  EXPECT_EQ(back.cells, field.cells);
}

}  // namespace
}  // namespace lpv::reference
