// Kaplanyan & Dachsbacher's propagation: two forms, one result, and what it must keep (MATHS.md 3a, 6.6).
#include "reference/propagate.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/compare.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

Field randomField(const glm::ivec3& dims, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> value(-1.0, 1.0);
  Field field(dims);
  for (auto& cell : field.cells) {
    for (Coefficients& c : cell) c = {value(random), value(random), value(random), value(random)};
  }
  return field;
}

/// A lobe of one cell, different per colour.
Field lobeIn(const glm::ivec3& dims, const glm::ivec3& cell) {
  Field field(dims);
  field.at(cell) = {lobe({0, 1, 0}), 2.0 * lobe({0.6, 0, -0.8}), 0.5 * lobe({-1, 0, 0})};
  return field;
}

double sumOfBand0(const Field& field, std::size_t colour) {
  double sum = 0.0;
  for (const auto& cell : field.cells) sum += cell[colour].x;
  return sum;
}

double norm(const Field& field) {
  double squares = 0.0;
  for (const auto& cell : field.cells) {
    for (const Coefficients& c : cell) squares += glm::dot(c, c);
  }
  return std::sqrt(squares);
}

bool finite(const Field& field) { return std::isfinite(norm(field)); }

// The near face's solid angle, 2 pi / 3, leaves through the five others. The closed form is MATHS.md 3a's.
TEST(FaceSolidAngles, MatchTheClosedFormAndAddUp) {
  const auto [front, side] = faceSolidAngles();
  EXPECT_NEAR(front, 4.0 * std::atan(0.25 / (1.5 * std::sqrt(2.75))), 1e-15);
  EXPECT_NEAR(front, 0.40066968464624, 1e-14);
  EXPECT_NEAR(side, 0.42343135443674, 1e-14);  // not .4234413544: the slip would fail by 1e-5
  EXPECT_NEAR(front + 4.0 * side, 2.0 * pi() / 3.0, 1e-14);
}

TEST(Stencil, ConstantsAreThoseOfTheSpecification) {
  const Stencil k = stencil();
  EXPECT_NEAR(k.a00, 1.0 / 6.0, 1e-15);
  EXPECT_NEAR(k.a01, 0.26402917, 5e-9);  // printed to 8 digits
  EXPECT_NEAR(k.a10, 0.03681680, 5e-9);
  EXPECT_NEAR(k.a11, 0.06376856, 5e-9);
  EXPECT_NEAR(k.b, 0.06027652, 5e-9);
}

// Red with the 10-digit solid angle in one of the two, a sign of a01 or a10 turned, or one tangent left out.
TEST(Propagate, StencilEqualsThirtyFaces) {
  Field faces = randomField({7, 6, 5}, 3);
  Field stencilled = faces;
  for (int i = 0; i < 10; ++i) {
    faces = stepFaces(faces);
    stencilled = stepStencil(stencilled);
    ASSERT_LE(largestDifference(faces, stencilled), 1e-14) << "step " << i;
  }
  const Field injected = lobeIn({9, 9, 9}, {2, 4, 4});
  EXPECT_LE(relativeL2(propagateStencil(injected, 12), propagateFaces(injected, 12)), 1e-14);
}

// Seven steps from the middle of 15 cells do not leave the grid; the eighth does.
TEST(Propagate, KeepsBandZeroUntilTheBorder) {
  Field u = lobeIn(glm::ivec3(15), glm::ivec3(7));
  for (int step = 1; step <= 7; ++step) {
    const Field next = stepFaces(u);
    for (std::size_t colour = 0; colour < 3; ++colour) {
      EXPECT_NEAR(sumOfBand0(next, colour) / sumOfBand0(u, colour), 1.0, 1e-12) << "step " << step;
    }
    u = next;
  }
  const double before = sumOfBand0(u, 0);
  EXPECT_LT(sumOfBand0(stepFaces(u), 0), before * (1.0 - 1e-6));
}

TEST(Propagate, ClampingFacesAddsEnergyInTheFirstStep) {
  const Field u = lobeIn(glm::ivec3(7), glm::ivec3(3));
  const double share = sumOfBand0(stepFaces(u, true), 0) / sumOfBand0(u, 0);
  EXPECT_GT(share, 1.10);  // MATHS.md 3a: 11-14 %
  EXPECT_LT(share, 1.15);
}

TEST(Propagate, TheNormNeverGrows) {
  Field u = randomField({6, 7, 8}, 5);
  for (int step = 0; step < 40; ++step) {
    const Field next = stepStencil(u);
    ASSERT_LE(norm(next), norm(u) * (1.0 + 1e-15)) << "step " << step;
    u = next;
  }
}

TEST(Propagate, AThousandStepsStayNumbers) {
  const Field injected = lobeIn({6, 5, 4}, {1, 1, 1});
  EXPECT_TRUE(finite(propagateStencil(injected, 1000)));
  EXPECT_TRUE(finite(propagateFaces(injected, 1000, true)));
}

TEST(Propagate, NothingComesFromOutsideAndNothingIsKept) {
  Field one(glm::ivec3(1));
  one.cells[0] = {lobe({0, 0, 1}), {}, {}};
  EXPECT_EQ(norm(stepFaces(one)), 0.0);
  EXPECT_EQ(norm(stepStencil(one)), 0.0);
  EXPECT_EQ(largestDifference(propagateFaces(one, 5), one), 0.0);  // the injected field is part of the sum
}

// One step from one cell reaches its 6 neighbours and no other.
TEST(Propagate, OneStepReachesSixNeighbours) {
  const glm::ivec3 middle(2);
  const Field next = stepFaces(lobeIn(glm::ivec3(5), middle));
  forEachCell(next.dims, [&](const glm::ivec3& cell) {
    const glm::ivec3 d = glm::abs(cell - middle);
    EXPECT_EQ(next.at(cell)[0] != Coefficients(0.0), d.x + d.y + d.z == 1);
  });
}

TEST(Propagate, IsLinear) {
  const Field a = randomField(glm::ivec3(5), 7);
  const Field b = randomField(glm::ivec3(5), 8);
  Field sum(a.dims);
  for (std::size_t i = 0; i < sum.cells.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) sum.cells[i][c] = a.cells[i][c] + 3.0 * b.cells[i][c];
  }
  const Field steppedA = stepFaces(a);
  const Field steppedB = stepFaces(b);
  Field expected(a.dims);
  for (std::size_t i = 0; i < sum.cells.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) expected.cells[i][c] = steppedA.cells[i][c] + 3.0 * steppedB.cells[i][c];
  }
  EXPECT_LE(largestDifference(stepFaces(sum), expected), 1e-14);
}

// The cyclic turn x -> y -> z -> x of cells and of band 1 commutes with a step: no axis is special.
TEST(Propagate, AxesAreEqual) {
  const auto turned = [](const Field& f) {
    Field out(glm::ivec3(f.dims.z, f.dims.x, f.dims.y));
    forEachCell(f.dims, [&](const glm::ivec3& c) {
      for (std::size_t k = 0; k < 3; ++k) {
        const Coefficients& from = f.at(c)[k];  // (u0, y, z, x): the new x is the old z, and so on
        out.at({c.z, c.x, c.y})[k] = {from.x, from.w, from.y, from.z};
      }
    });
    return out;
  };
  const Field u = randomField({4, 5, 6}, 9);
  EXPECT_LE(largestDifference(stepFaces(turned(u)), turned(stepFaces(u))), 1e-15);
}

// In the interior and for a uniform field, band 0 is kept and band 1 shrinks to 2 a11 + 4 b = .36864 (MATHS.md 3a).
TEST(Propagate, BandOneShrinksToTheKnownShare) {
  Field u(glm::ivec3(5));
  for (auto& cell : u.cells) cell.fill({1.0, 0.5, -0.25, 2.0});
  const Coefficients next = stepFaces(u).at({2, 2, 2})[0];
  EXPECT_NEAR(next.x, 1.0, 1e-14);
  EXPECT_NEAR(next.y / 0.5, 0.36864, 5e-6);
  EXPECT_NEAR(next.z / -0.25, next.w / 2.0, 1e-14);
}

}  // namespace
}  // namespace lpv::reference
