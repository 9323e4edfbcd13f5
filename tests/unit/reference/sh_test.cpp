// Everything else stands on these: the basis is orthonormal, the lobe is the lobe.
#include <gtest/gtest.h>

#include <cmath>

#include "reference/sh.h"

namespace lpv::reference {
namespace {

// The quadrature is exact for these polynomials; what is left is rounding of about 2300 terms.
constexpr double kRounding = 1e-13;

const glm::dvec3 kSomeAxis = glm::normalize(glm::dvec3(0.3, -0.7, 0.4));

TEST(ReferenceSh, QuadratureGivesTheSphereItsArea) {
  EXPECT_NEAR(integrate([](const glm::dvec3&) { return 1.0; }), 4.0 * pi(), kRounding);
  EXPECT_NEAR(integrate([](const glm::dvec3& w) { return w.x * w.x * w.y * w.y; }), 4.0 * pi() / 15.0, kRounding);
}

// Red when a constant is off by one digit, when two axes are exchanged with a wrong sign, or a band misses its root.
TEST(ReferenceSh, BasisIsOrthonormal) {
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const double product = integrate([&](const glm::dvec3& w) { return basis(w)[a] * basis(w)[b]; }, kSomeAxis);
      EXPECT_NEAR(product, a == b ? 1.0 : 0.0, kRounding) << "coefficients " << a << " and " << b;
    }
  }
}

TEST(ReferenceSh, OrderIsYZXWithoutSigns) {
  EXPECT_GT(basis({0, 1, 0})[1], 0.48);
  EXPECT_GT(basis({0, 0, 1})[2], 0.48);
  EXPECT_GT(basis({1, 0, 0})[3], 0.48);
}

// The kink of max(0, n.w) lies on the border of the two hemispheres that `integrate` treats apart, so this is exact.
TEST(ReferenceSh, LobeIsTheProjectedClampedCosine) {
  for (const glm::dvec3& n : {glm::dvec3(0, 0, 1), glm::dvec3(-1, 0, 0), kSomeAxis}) {
    const Coefficients quadrature = project([&](const glm::dvec3& w) { return std::max(0.0, glm::dot(n, w)); }, n);
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(lobe(n)[k], quadrature[k], kRounding) << "coefficient " << k;
  }
}

// A0 = 2 pi Int_0^1 z dz, A1 = 2 pi Int_0^1 z z dz (Ramamoorthi & Hanrahan 2001).
TEST(ReferenceSh, ZonalFactorsArePiAndTwoThirdsPi) {
  const glm::dvec3 z(0, 0, 1);
  const double a0 = integrate([](const glm::dvec3& w) { return std::max(0.0, w.z); });
  const double a1 = integrate([](const glm::dvec3& w) { return std::max(0.0, w.z) * w.z; });
  EXPECT_NEAR(a0, pi(), kRounding);
  EXPECT_NEAR(a1, 2.0 * pi() / 3.0, kRounding);
  EXPECT_NEAR(lobe(z)[0], std::sqrt(pi()) / 2.0, kRounding);
  EXPECT_NEAR(lobe(z)[2], std::sqrt(pi() / 3.0), kRounding);
}

TEST(ReferenceSh, EvaluateReturnsWhatWasProjected) {
  const auto linear = [](const glm::dvec3& w) { return 2.0 + w.x - 3.0 * w.y + 0.5 * w.z; };
  const Coefficients c = project(linear);
  EXPECT_NEAR(evaluate(c, kSomeAxis), linear(kSomeAxis), kRounding);
}

}  // namespace
}  // namespace lpv::reference
