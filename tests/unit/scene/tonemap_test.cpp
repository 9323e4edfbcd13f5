// The published curve against a second writing of it.
#include "scene/tonemap.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reference/display.h"

namespace lpv {
namespace {

TEST(ToneCurve, EqualsTheReference) {
  for (double x = 1e-7; x < 1e7; x *= 1.01) EXPECT_NEAR(toneCurve(x), reference::curve(x), 1e-14) << x;
  EXPECT_EQ(toneCurve(0.0), 0.0);
  EXPECT_EQ(toneCurve(-1.0), 0.0);
  EXPECT_EQ(toneCurve(1e30), 1.0);
}

TEST(Srgb, EqualsTheReferenceAndInverts) {
  for (int i = 0; i <= 1000; ++i) {
    const double x = i / 1000.0;
    EXPECT_NEAR(srgbFromLinear(x), reference::encodeSrgb(x), 1e-15) << x;
    // The standard's two pieces meet to 3e-8 only, so bisection and formula differ by that at the joint.
    EXPECT_NEAR(linearFromSrgb(x), reference::decodeSrgb(x), 5e-8) << x;
    EXPECT_NEAR(linearFromSrgb(srgbFromLinear(x)), x, 5e-8) << x;
  }
}

TEST(DisplayFromRadiance, EqualsTheReferenceButForTies) {
  int apart = 0;
  for (int i = 0; i < 3000; ++i) {
    const glm::dvec3 c(i * 1e-4, i * 1e-3, i * 1e-2);
    for (const double ev : {-3.0, 0.0, 2.5}) {
      const glm::ivec3 d = glm::ivec3(displayFromRadiance(c, ev)) - glm::ivec3(reference::displayOf(c, ev));
      for (int k = 0; k < 3; ++k) {
        EXPECT_LE(std::abs(d[k]), 1);
        apart += d[k] != 0;
      }
    }
  }
  EXPECT_LE(apart, 2);  // a rounding tie may fall either way
}

// HDR radiance of any size, and what is no number at all, ends in 0..255 (MATHS.md 6.10). inf / inf is a NaN.
TEST(DisplayFromRadiance, HasAnAnswerForEveryNumber) {
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(displayFromRadiance({1e300, infinity, 1e155}, 0.0), glm::u8vec3(255));
  EXPECT_EQ(displayFromRadiance({-1.0, -infinity, 0.0}, 0.0), glm::u8vec3(0));
  EXPECT_EQ(displayFromRadiance(glm::dvec3(std::nan("")), 0.0), glm::u8vec3(0));
}

}  // namespace
}  // namespace lpv
