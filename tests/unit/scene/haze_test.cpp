// Haze fills its box, and nothing outside it.
#include "scene/haze.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "scene/scene.h"
#include "scene/shadowing.h"

namespace lpv {
namespace {

const Haze kHaze = {{{-1.0, 0.0, 2.0}, {2.0, 1.0, 4.0}}, 0.7};

/// Metres of a segment within the box, by many steps.
double withinBox(const glm::dvec3& a, const glm::dvec3& b) {
  constexpr int kSteps = 20000;
  int inside = 0;
  for (int i = 0; i < kSteps; ++i) {
    const glm::dvec3 p = glm::mix(a, b, (i + 0.5) / kSteps);
    const bool here =
        glm::all(glm::greaterThanEqual(p, kHaze.box.min)) && glm::all(glm::lessThanEqual(p, kHaze.box.max));
    inside += here ? 1 : 0;
  }
  return glm::distance(a, b) * inside / kSteps;
}

// Broken by: the whole way's length; a box without its lower or its upper side.
TEST(Haze, TakesLightWithinItsBox) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  for (int i = 0; i < 300; ++i) {
    const auto point = [&] {
      return glm::dvec3(0.5, 0.5, 3.0) + 3.0 * glm::dvec3(unit(random), unit(random), unit(random));
    };
    const glm::dvec3 a = point(), b = point();
    EXPECT_NEAR(kHaze.transmittance(a, b), std::exp(-0.7 * withinBox(a, b)), 1e-3);
    EXPECT_NEAR(kHaze.transmittance(a, b), kHaze.transmittance(b, a), 1e-12);
  }
}

TEST(Haze, TakesLightAlongAxes) {
  EXPECT_NEAR(kHaze.transmittance({-5.0, 0.5, 3.0}, {5.0, 0.5, 3.0}), std::exp(-0.7 * 3.0), 1e-12);
  EXPECT_NEAR(kHaze.transmittance({0.0, 0.5, 3.0}, {0.0, 0.5, 9.0}), std::exp(-0.7 * 1.0), 1e-12);
  EXPECT_EQ(kHaze.transmittance({-5.0, 1.5, 3.0}, {5.0, 1.5, 3.0}), 1.0);
  EXPECT_EQ(kHaze.transmittance({0.0, 0.5, 3.0}, {0.0, 0.5, 3.0}), 1.0);
  EXPECT_EQ(Haze().transmittance({0.0, 0.0, 0.0}, {1.0, 1.0, 1.0}), 1.0);
}

// Broken by: haze of a scene without any; light that is not looked at along rays in haze.
TEST(Haze, FillsTheGridOfItsScene) {
  Scene scene;
  scene.grid = {glm::dvec3(-1.0), 0.5, glm::ivec3(4)};
  EXPECT_FALSE(hazeOf(scene).any());
  EXPECT_FALSE(isShadowed(scene));
  scene.options.haze = 0.3;
  EXPECT_TRUE(isShadowed(scene));
  EXPECT_EQ(hazeOf(scene), (Haze{{glm::dvec3(-1.0), glm::dvec3(1.0)}, 0.3}));
}

}  // namespace
}  // namespace lpv
