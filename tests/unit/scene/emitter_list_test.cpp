// Irradiance from the lights themselves, on the CPU, against the closed form of the reference and against trees put
// together by hand.
#include "scene/emitter_list.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "reference/direct_texels.h"
#include "reference/ground_truth.h"

namespace lpv {
namespace {

using Corners = std::array<glm::dvec3, 3>;

glm::dvec3 randomVector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return {x, y, normal(random)};
}

/// From the origin.
double got(const Corners& c, const glm::dvec3& n, int sides) {
  const glm::dvec3 corners[3] = {c[0], c[1], c[2]};
  return triangleIrradiance(corners, n, sides);
}

double want(const Corners& c, const glm::dvec3& n, int sides) {
  const double front = reference::triangleIrradiance(c, glm::dvec3(0.0), n);
  return sides < 2 ? front : front + reference::triangleIrradiance({c[0], c[2], c[1]}, glm::dvec3(0.0), n);
}

/// As far apart as `change` lets random triangles come, as a share of the largest; how many are lit.
template <typename Change>
void expectReferences(const std::string& name, Change change, int least) {
  std::mt19937 random(1);
  double apart = 0.0, largest = 0.0;
  int lit = 0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 n = glm::normalize(randomVector(random));
    Corners c = {randomVector(random), randomVector(random), randomVector(random)};
    change(c, n);
    for (const int sides : {1, 2}) {
      const double e = got(c, n, sides), truth = want(c, n, sides);
      ASSERT_TRUE(std::isfinite(e) && e >= 0.0) << name << " " << i;
      apart = std::max(apart, std::abs(e - truth));
      largest = std::max(largest, truth);
      lit += truth > 0.0 ? 1 : 0;
    }
  }
  EXPECT_LE(apart, 1e-12 * std::max(largest, 1.0)) << name;
  EXPECT_GE(lit, least) << name;
}

glm::dvec3 above(const glm::dvec3& p, const glm::dvec3& n) { return glm::dot(p, n) < 0.0 ? -p : p; }

// Broken by: no edge along the horizon; p + (q - p) t where an edge crosses it, by near and far corners; light from
// behind.
TEST(TriangleIrradiance, IsTheReferences) {
  expectReferences(
      "anywhere", [](Corners&, const glm::dvec3&) {}, 15000);
  expectReferences(
      "above the horizon",
      [](Corners& c, const glm::dvec3& n) {
        for (glm::dvec3& p : c) p = above(p, n);
      },
      25000);
  expectReferences(
      "one corner above",
      [](Corners& c, const glm::dvec3& n) {
        c = {above(c[0], n), -above(c[1], n), -above(c[2], n)};
      },
      25000);
  expectReferences(
      "two corners above",
      [](Corners& c, const glm::dvec3& n) {
        c = {-above(c[0], n), above(c[1], n), above(c[2], n)};
      },
      25000);
  expectReferences(
      "below",
      [](Corners& c, const glm::dvec3& n) {
        for (glm::dvec3& p : c) p = -above(p, n);
      },
      0);
  expectReferences(
      "thin", [](Corners& c, const glm::dvec3&) { c[2] = c[1] + 1e-6 * c[2]; }, 10000);
  expectReferences(
      "near and far",
      [](Corners& c, const glm::dvec3&) {
        c = {1e-6 * c[0], c[1], 1e6 * c[2]};
      },
      10000);
}

/// Along a coordinate axis, where a product with the normal is exact.
glm::dvec3 axisOf(const glm::dvec3& n) { return {0.0, 0.0, n.z < 0.0 ? -1.0 : 1.0}; }

// Corners on the horizon itself.
// Broken by: no edge along the horizon.
TEST(TriangleIrradiance, WithCornersOnTheHorizonIsTheReferences) {
  std::mt19937 random(2);
  double apart = 0.0;
  for (int i = 0; i < 20000; ++i) {
    const glm::dvec3 n = axisOf(randomVector(random));
    Corners c = {randomVector(random), randomVector(random), randomVector(random)};
    const int down = 1 + i % 7;
    for (int k = 0; k < 3; ++k) {
      if (down >> k & 1) c[std::size_t(k)].z = 0.0;
    }
    for (const int sides : {1, 2}) {
      const double e = got(c, n, sides);
      apart = std::max(apart, std::abs(e - want(c, n, sides)));
      if (down == 7) {
        EXPECT_EQ(e, 0.0) << "in the plane of the horizon";
      }
    }
  }
  EXPECT_LE(apart, 1e-12);
}

TEST(TriangleIrradiance, ComesFromTheFrontOrFromBothSides) {
  const Corners seen = {glm::dvec3(0, 0, 1), glm::dvec3(0, 1, 1), glm::dvec3(1, 0, 1)};
  const Corners turned = {seen[0], seen[2], seen[1]};
  const glm::dvec3 n(0, 0, 1);
  EXPECT_GT(got(seen, n, 1), 0.1);
  EXPECT_EQ(got(turned, n, 1), 0.0);
  EXPECT_EQ(got(seen, n, 2), got(seen, n, 1));
  EXPECT_NEAR(got(turned, n, 2), got(seen, n, 1), 1e-15);
}

// At a corner, on an edge, on the face: nothing or all, and never not a number; a little in front of the face: pi.
TEST(TriangleIrradiance, OfATriangleThatTheReceiverTouches) {
  const Corners c = {glm::dvec3(-1, -1, 0), glm::dvec3(-1, 2, 0), glm::dvec3(2, -1, 0)};
  const auto movedTo = [&](const glm::dvec3& x) { return Corners{c[0] - x, c[1] - x, c[2] - x}; };
  for (const glm::dvec3& n :
       {glm::dvec3(0, 0, 1), glm::dvec3(0, 0, -1), glm::dvec3(1, 0, 0), glm::dvec3(0.6, 0, 0.8)}) {
    for (const glm::dvec3& x : {c[0], c[1], c[2], glm::dvec3(-1, 0, 0), glm::dvec3(0.5, 0.5, 0), glm::dvec3(0.0)}) {
      for (const int sides : {1, 2}) EXPECT_EQ(got(movedTo(x), n, sides), 0.0);
    }
    for (const double height : {1e-3, 1e-6, 1e-9, 1e-12}) {
      const Corners near = movedTo({0, 0, -height});
      EXPECT_NEAR(got(near, n, 1), reference::triangleIrradiance(near, glm::dvec3(0.0), n), 1e-12);
    }
  }
  EXPECT_NEAR(got(movedTo({0, 0, -1e-9}), {0, 0, 1}, 1), std::acos(-1.0), 1e-8);
}

// MATHS.md 5: a unit square at distance 1.
TEST(TriangleIrradiance, CheckValue) {
  const glm::dvec3 a(-0.5, -0.5, 1), b(0.5, -0.5, 1), c(0.5, 0.5, 1), d(-0.5, 0.5, 1), n(0, 0, 1);
  EXPECT_NEAR(got({a, c, b}, n, 1) + got({a, d, c}, n, 1), 0.7522746884541, 1e-13);
}

constexpr double kSize = 8.0;

/// As the session would have it, over cells of half a metre.
EmitterList lightsOf(const std::vector<reference::DirectLight>& lights, double k) {
  EmitterList direct;
  direct.grid = {{1.0, -2.0, 0.5}, 0.5, glm::ivec3(int(kSize))};
  direct.always = true;
  direct.texels = reference::directTexels(lights, k);
  return direct;
}

void expectSum(const std::string& name, const std::vector<reference::DirectLight>& lights) {
  std::mt19937 random(3);
  for (const double k : {0.0, 1.5, 4.0, 1e15}) {
    const EmitterList direct = lightsOf(lights, k);
    double apart = 0.0, largest = 0.0;
    for (int i = 0; i < 500; ++i) {
      const glm::dvec3 x = 0.5 * kSize + 0.5 * kSize * randomVector(random);
      const glm::dvec3 n = glm::normalize(randomVector(random));
      const glm::dvec3 e = direct.irradiance(direct.grid.worldFromGrid(x), n);
      const glm::dvec3 truth = reference::directIrradiance(lights, k, x, n);
      for (int c = 0; c < 3; ++c) {
        apart = std::max(apart, std::abs(e[c] - truth[c]));
        largest = std::max(largest, truth[c]);
      }
    }
    EXPECT_GT(largest, 0.0) << name;
    // The spread is kept as a float.
    EXPECT_LE(apart, 1e-7 * largest) << name << ", k " << k;
  }
}

// Broken by: records of three texels read as of two; a node taken whole whose children are walked too.
TEST(EmitterList, AreWhatTheirTexelsSay) {
  using reference::randomPolygons;
  using reference::randomTree;
  expectSum("polygons", {randomPolygons(5, false, kSize, 1)});
  expectSum("polygons, both sides", {randomPolygons(5, true, kSize, 2)});
  expectSum("tree", {randomTree(false, false, kSize, 3)});
  expectSum("tree, both sides", {randomTree(false, true, kSize, 4)});
  expectSum("tree with colours", {randomTree(true, false, kSize, 5)});
  expectSum("tree with colours, both sides", {randomTree(true, true, kSize, 6)});
  expectSum("all of them", {randomTree(true, true, kSize, 6), randomPolygons(5, false, kSize, 1),
                            randomTree(false, false, kSize, 3), randomPolygons(2, true, kSize, 2)});
}

TEST(EmitterList, NoLightIsDark) {
  EXPECT_EQ(lightsOf({}, 2.0).irradiance(glm::dvec3(0.0), {0, 1, 0}), glm::dvec3(0.0));
}

/// 6 x 3 x 4 cells; how near an emitter is grows by `step` a cell along x.
EmitterList ramp(double first, double step) {
  EmitterList direct;
  direct.grid = {{-1.0, 2.0, 0.5}, 0.5, {6, 3, 4}};
  for (std::size_t i = 0; i < direct.grid.cells(); ++i)
    direct.emitterDistance.push_back(float(first + step * double(i % 6)));
  return direct;
}

double farAt(const EmitterList& direct, const glm::dvec3& g) {
  return direct.farFromEmitters(direct.grid.worldFromGrid(g));
}

// Broken by: interpolation between corners of cells; no smoothstep.
TEST(FarFromEmitters, IsASmoothstepOfTheInterpolatedDistance) {
  const EmitterList direct = ramp(1.0, 0.5);  // 1 .. 3.5 cells
  for (double x = 0.5; x <= 5.5; x += 0.0625) {
    const double t = std::clamp(1.0 + 0.5 * (x - 0.5) - 2.0, 0.0, 1.0);
    for (const glm::dvec3 g : {glm::dvec3(x, 1.5, 2.0), glm::dvec3(x, 0.5, 0.5), glm::dvec3(x, 2.25, 3.25)})
      EXPECT_NEAR(farAt(direct, g), t * t * (3.0 - 2.0 * t), 1e-12) << x;
  }
  EXPECT_EQ(farAt(direct, {2.5, 1.5, 1.5}), 0.0) << "2 cells";
  EXPECT_EQ(farAt(direct, {4.5, 1.5, 1.5}), 1.0) << "3 cells";
  EXPECT_DOUBLE_EQ(farAt(direct, {3.5, 1.5, 1.5}), 0.5);
}

// Beyond the outermost centres there is nothing to interpolate between: the lights are looked at.
// Broken by: 1 beyond them, or within half a cell of the bounds.
TEST(FarFromEmitters, AtTheGridsEnd) {
  const EmitterList direct = ramp(10.0, 0.0);
  const glm::dvec3 dims(direct.grid.dims);
  for (int axis = 0; axis < 3; ++axis) {
    for (const double away : {-0.25, 0.0, 0.01, 0.25, 0.5, 2.0, 1e6}) {
      glm::dvec3 below(1.5), beyond(1.5);
      below[axis] = 0.5 - away;
      beyond[axis] = dims[axis] - 0.5 + away;
      for (const glm::dvec3& g : {below, beyond}) EXPECT_EQ(farAt(direct, g), away <= 0.0 ? 1.0 : 0.0) << away;
    }
  }
}

TEST(FarFromEmitters, NowhereWithDirect) {
  EmitterList direct = ramp(10.0, 0.0);
  direct.always = true;
  direct.emitterDistance.clear();
  EXPECT_EQ(farAt(direct, {1.5, 1.5, 1.5}), 0.0);
}

TEST(FarFromEmitters, OfOneCell) {
  EmitterList direct;
  direct.grid = {glm::dvec3(0.0), 1.0, glm::ivec3(1)};
  direct.emitterDistance = {2.5F};
  EXPECT_DOUBLE_EQ(farAt(direct, glm::dvec3(0.5)), 0.5);
  for (const double x : {-0.4, 0.0, 0.4, 0.6, 1.4}) EXPECT_EQ(farAt(direct, glm::dvec3(x)), 0.0);
}

}  // namespace
}  // namespace lpv
