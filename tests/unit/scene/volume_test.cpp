// Irradiance from a volume: the product's lookup against the reference's (MATHS.md 4).
#include "scene/volume.h"
#include "scene/lookup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/packing.hpp>
#include <random>

#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/volume.h"

namespace lpv {
namespace {

Grid someGrid(const glm::ivec3& dims) {
  Grid grid;
  grid.origin = {-3.0, 1.0, 20.0};
  grid.cell = 0.4;
  grid.dims = dims;
  return grid;
}

reference::Field randomField(const glm::ivec3& dims, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(-1.0F, 1.0F);
  reference::Field field(dims);
  for (auto& cell : field.cells) {
    for (reference::Coefficients& c : cell) c = {value(random) + 1.5F, value(random), value(random), value(random)};
  }
  return field;
}

glm::dvec3 randomUnit(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return glm::normalize(glm::dvec3(x, y, normal(random)));
}

/// SH of incident radiance with fluence phi and vector irradiance d.
sh::Coefficients withMoments(double phi, const glm::dvec3& d) {
  return reference::basis(glm::dvec3(1.0)) * sh::Coefficients(phi, d.y, d.z, d.x);
}

/// A unit vector at the angle whose cosine is given from unit w.
glm::dvec3 tiltedBy(double cosine, const glm::dvec3& w, std::mt19937& random) {
  const glm::dvec3 across = glm::normalize(glm::cross(w, randomUnit(random)));
  return cosine * w + std::sqrt(1.0 - cosine * cosine) * across;
}

/// Random points in and around the grid with random normals.
template <typename Visit>
void forSomePoints(const Grid& grid, Visit visit) {
  std::mt19937 random(77);
  std::uniform_real_distribution<double> at(-1.2, 1.0);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 2000; ++i) {
    const glm::dvec3 share = glm::dvec3(at(random), at(random), at(random)) + 0.6;
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    visit(grid.worldFromGrid(share * glm::dvec3(grid.dims)), n);
  }
}

TEST(IrradianceSh2, EqualsTheReference) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 200; ++i) {
    const sh::Coefficients c(normal(random), normal(random), normal(random), normal(random));
    const glm::dvec3 n = glm::normalize(glm::dvec3(normal(random), normal(random), normal(random)));
    EXPECT_NEAR(irradianceSh2(c, n), reference::sh2(c, n), 1e-13);
  }
}

// Broken by: the sign of |cos tilt|, SH2 up to rho = .6, D max(0, cos tilt) left out.
// Caps of every size, down to where both take them for a point, about normals of every tilt, most near the horizon.
TEST(IrradianceCap, EqualsTheReference) {
  std::mt19937 random(8);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  for (int i = 0; i < 20000; ++i) {
    const double rho = i % 3 == 0 ? 1.3 * uniform(random) : 1.0 - std::pow(10.0, -8.0 * uniform(random));
    const double sine = std::sqrt(std::max(0.0, 4.0 * rho * (1.0 - rho)));
    const double reach = std::min(1.0, rho < 0.5 ? 1.0 : 1.2 * sine);
    const glm::dvec3 w = randomUnit(random);
    const glm::dvec3 n = tiltedBy(reach * (2.0 * uniform(random) - 1.0), w, random);
    const sh::Coefficients c = withMoments(1.0, rho * w);
    ASSERT_NEAR(irradianceCap(c, n), reference::cap(c, n), 1e-12) << "rho " << rho << ", cosine " << glm::dot(w, n);
  }
}

/// Exact moments of a light of radiance 1, seen from a random point; cap against closed form.
struct CapErrors {
  double whereAllIsAbove = 0.0;  ///< largest error as a share of phi, light and cap above the horizon
  double relativeL2 = 0.0;       ///< over all points that see any of it
  int above = 0;
};
CapErrors capErrors(const reference::Emitters& light, double lightRadius, double nearest, double farthest) {
  std::mt19937 random(21);
  std::uniform_real_distribution<double> distance(nearest, farthest);
  CapErrors out;
  double squares = 0.0, truths = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const double r = distance(random);
    const glm::dvec3 x = r * randomUnit(random), n = randomUnit(random);
    const sh::Coefficients c = reference::incidentSh(light.triangles, x)[0];
    const double phi = sh::fluence(c), length = glm::length(sh::vectorIrradiance(c));
    if (phi == 0.0) continue;
    const double e = irradianceCap(c, n), truth = reference::irradianceOf(light.triangles, x, n).x;
    squares += (e - truth) * (e - truth);
    truths += truth * truth;
    const double sine = std::sqrt(4.0 * length / phi * (1.0 - length / phi));
    const bool capAbove = glm::dot(sh::vectorIrradiance(c), n) > length * sine;
    if (!capAbove || glm::dot(-x, n) < lightRadius) continue;
    out.whereAllIsAbove = std::max(out.whereAllIsAbove, std::abs(e - truth) / phi);
    ++out.above;
  }
  out.relativeL2 = std::sqrt(squares / truths);
  return out;
}

// MATHS.md 4: exact above the horizon; 0-1 % over random points and normals (SH2: 20 %). Seen: quad .57 %, sphere
// .02 %. Broken by: the sign of |cos tilt|, D max(0, cos tilt) left out.
TEST(IrradianceCap, IsExactForLightsAboveTheHorizonAndCloseAcrossIt) {
  Grid grid = someGrid(glm::ivec3(1));
  const auto light = [&](const MeshPtr& mesh) {
    return reference::emittersOf(grid, *mesh, glm::dmat4(1.0), glm::dvec3(1.0), false);
  };
  const CapErrors quad = capErrors(light(reference::quad()), std::sqrt(0.5), 1.5, 6.0);
  EXPECT_GT(quad.above, 300);
  EXPECT_LE(quad.whereAllIsAbove, 1e-12);
  EXPECT_LE(quad.relativeL2, 0.01);
  const CapErrors sphere = capErrors(light(reference::sphereOf(12, 8)), 0.5, 1.5, 6.0);
  EXPECT_GT(sphere.above, 300);
  EXPECT_LE(sphere.whereAllIsAbove, 1e-12);
  EXPECT_LE(sphere.relativeL2, 0.01);
  RecordProperty("quad", std::to_string(quad.relativeL2));
  RecordProperty("sphere", std::to_string(sphere.relativeL2));
}

glm::dvec4 throughHalf(const glm::dvec4& c) { return glm::dvec4(glm::unpackHalf(glm::packHalf(glm::vec4(c)))); }

// MATHS.md 6.4, the lookup's half. Half floats round phi and D apart: |D| comes out above phi.
// Broken by: no test of phi, no max(0, .) in SH2.
TEST(Invariant4, LookupsAreFiniteAndNotNegativeForAnyMoments) {
  const auto ask = [](const sh::Coefficients& c, const glm::dvec3& n) {
    for (const sh::Coefficients& given : {c, throughHalf(c)}) {
      for (const double e : {irradianceCap(given, n), irradianceSh2(given, n)}) {
        ASSERT_TRUE(std::isfinite(e) && e >= 0.0) << e << " of " << c.x << " " << c.y << " " << c.z << " " << c.w;
      }
    }
  };
  std::mt19937 random(5);
  EXPECT_EQ(irradianceCap(withMoments(0.0, {0, 0, 1}), {0, 0, 1}), 0.0);
  EXPECT_EQ(irradianceCap(withMoments(-1.0, {0, 0, 1}), {0, 0, 1}), 0.0);
  for (const double phi : {0.0, -1.0, 6e-8, 1e-3, 1.0, 1e4}) {
    for (int step = 0; step <= 400; ++step) {
      const double rho = step / 320.0;
      const glm::dvec3 w = step % 2 ? randomUnit(random) : glm::dvec3(0, 0, 1);
      for (const glm::dvec3& n : {w, -w, randomUnit(random), tiltedBy(1e-9, w, random)}) {
        ask(withMoments(phi, phi * rho * w), n);
        ask(withMoments(phi, rho * w), n);
      }
    }
  }
}

// Red when a weight, the half-cell offset, the clamp or the order of coefficients is off, also for flat grids.
TEST(IrradianceAt, EqualsTheReferenceForEveryLookup) {
  for (const glm::ivec3& dims : {glm::ivec3(5, 4, 6), glm::ivec3(1, 7, 1), glm::ivec3(1)}) {
    const Grid grid = someGrid(dims);
    const reference::Field field = randomField(dims, 4);
    const Volume volume = reference::toVolume(grid, field);
    int valid = 0;
    for (const Lookup how : {Lookup::kSh2, Lookup::kCap, Lookup::kNearest}) {
      forSomePoints(grid, [&](const glm::dvec3& p, const glm::dvec3& n) {
        const Irradiance tested = irradianceAt(volume, how, p, n);
        const auto truth = reference::lookup(grid, field, how, p, n);
        ASSERT_EQ(tested.valid, truth.has_value());
        valid += tested.valid;
        for (int c = 0; c < 3; ++c) ASSERT_NEAR(tested.rgb[c], truth.value_or(glm::dvec3(0.0))[c], 1e-12);
      });
    }
    EXPECT_GT(valid, 100);
  }
}

TEST(IrradianceAt, SumsLayersAfterTheLookup) {
  const Grid grid = someGrid(glm::ivec3(3));
  Volume both = reference::toVolume(grid, randomField(grid.dims, 5));
  const Volume second = reference::toVolume(grid, randomField(grid.dims, 6));
  const Volume first = both;
  both.layers.push_back(second.layers[0]);
  for (const Lookup how : {Lookup::kSh2, Lookup::kCap}) {
    forSomePoints(grid, [&](const glm::dvec3& p, const glm::dvec3& n) {
      const glm::dvec3 apart = irradianceAt(first, how, p, n).rgb + irradianceAt(second, how, p, n).rgb;
      const glm::dvec3 together = irradianceAt(both, how, p, n).rgb;
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(together[c], apart[c], 1e-13);
    });
  }
}

TEST(IrradianceAt, IsInvalidBeyondHalfACellAndAtNoPlace) {
  const Grid grid = someGrid(glm::ivec3(4));
  const Volume volume = reference::toVolume(grid, randomField(grid.dims, 7));
  const auto valid = [&](const glm::dvec3& g) {
    return irradianceAt(volume, Lookup::kSh2, grid.worldFromGrid(g), {0, 1, 0}).valid;
  };
  EXPECT_TRUE(valid({-0.499, 2, 2}));
  EXPECT_TRUE(valid({2, 2, 4.499}));
  EXPECT_FALSE(valid({-0.501, 2, 2}));
  EXPECT_FALSE(valid({2, 4.501, 2}));
  EXPECT_FALSE(valid({2, std::nan(""), 2}));
  EXPECT_FALSE(valid({1e300, 2, 2}));
}

TEST(VolumeAt, ReadsTheDocumentedOrder) {
  const Grid grid = someGrid({2, 3, 4});
  VolumeLayer layer;
  for (int i = 0; i < 2 * 3 * 4 * 12; ++i) layer.coefficients.push_back(float(i));
  const double first = double(((3 * 3 + 2) * 2 + 1) * 12 + 4);  // cell (1, 2, 3), colour 1
  EXPECT_EQ(Volume::at(layer, grid, {1, 2, 3}, 1), sh::Coefficients(first, first + 1, first + 2, first + 3));
}

}  // namespace
}  // namespace lpv
