// The product's SH constants against quadrature and against the reference's own.
#include "scene/sh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/sh.h"

namespace lpv::sh {
namespace {

// Exact quadrature of polynomials; rounding of about 2300 terms is left.
constexpr double kRounding = 1e-13;

const glm::dvec3 kSomeAxis = glm::normalize(glm::dvec3(0.48, 0.6, -0.64));

TEST(Sh, BasisIsOrthonormal) {
  for (int a = 0; a < 4; ++a) {
    for (int b = 0; b < 4; ++b) {
      const double product =
          reference::integrate([&](const glm::dvec3& w) { return basis(w)[a] * basis(w)[b]; }, kSomeAxis);
      EXPECT_NEAR(product, a == b ? 1.0 : 0.0, kRounding) << "coefficients " << a << " and " << b;
    }
  }
}

TEST(Sh, LobeIsTheProjectedClampedCosine) {
  for (const glm::dvec3& n : {glm::dvec3(0, 1, 0), glm::dvec3(0, 0, -1), kSomeAxis}) {
    for (int k = 0; k < 4; ++k) {
      const auto term = [&](const glm::dvec3& w) { return std::max(0.0, glm::dot(n, w)) * basis(w)[k]; };
      EXPECT_NEAR(lobe(n)[k], reference::integrate(term, n), kRounding) << "coefficient " << k;
    }
  }
}

TEST(Sh, EqualsTheReferenceInOrderAndSign) {
  for (int k = 0; k < 4; ++k) {
    EXPECT_NEAR(basis(kSomeAxis)[k], reference::basis(kSomeAxis)[k], 1e-16);
    EXPECT_NEAR(lobe(kSomeAxis)[k], reference::lobe(kSomeAxis)[k], 4e-16);
  }
}

TEST(Sh, ZonalFactorsArePiAndTwoThirdsPi) {
  EXPECT_NEAR(kLobe0 / kY0, kPi, 1e-15);
  EXPECT_NEAR(kLobe1 / kY1, 2.0 * kPi / 3.0, 1e-15);
}

TEST(Sh, BandOneIsAVectorAndBack) {
  const glm::dvec3 v(1, 2, 3);
  EXPECT_EQ(band1(fromBands(4.0, v)), v);
  EXPECT_EQ(fromBands(4.0, v), Coefficients(4, 2, 3, 1));
}

TEST(Sh, FluenceAndVectorIrradianceAreMoments) {
  const Coefficients c(1.0, 0.2, -0.3, 0.5);
  const auto radiance = [&](const glm::dvec3& w) { return glm::dot(c, basis(w)); };
  EXPECT_NEAR(fluence(c), reference::integrate(radiance), kRounding);
  for (int k = 0; k < 3; ++k) {
    const auto moment = [&](const glm::dvec3& w) { return radiance(w) * w[k]; };
    EXPECT_NEAR(vectorIrradiance(c)[k], reference::integrate(moment), kRounding);
  }
}

}  // namespace
}  // namespace lpv::sh
