// A scene's whole way to its volume.
#include "reference/pipeline.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/compare.h"
#include "reference/dense.h"
#include "reference/meshes.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

/// A turned pyramid in the middle of 9^3 cells of .25 m, everything `scale` times as large.
Scene sceneOfScale(double scale) {
  Scene scene;
  scene.options = LightingSettings::paper();
  scene.grid.dims = glm::ivec3(9);
  scene.grid.cell = 0.25 * scale;
  scene.grid.origin = glm::dvec3(-1.125 * scale);
  auto light = std::make_shared<Light>();
  light->mesh = pyramid();
  light->transform.scale = glm::dvec3(scale);
  light->transform.rotation = rotationFromEulerDegrees({30, 40, 50});
  light->radiance = {1.0, 2.0, 3.0};
  scene.lights["light"] = light;
  return scene;
}

// Radiance has no length in it: a scene three times as large looks the same. Red when a factor s^2 is lost.
TEST(Pipeline, ScaleDoesNotChangeIncidentRadiance) {
  for (const Injection injection : {Injection::kCount, Injection::kFlux}) {
    Scene one = sceneOfScale(1.0);
    Scene four = sceneOfScale(4.0);  // a power of two: snapping sees the same bits
    one.options.injection = four.options.injection = injection;
    EXPECT_LE(relativeL2(transportedField(four), transportedField(one)), 1e-13);
  }
}

TEST(Pipeline, DenseSamplesAreAsked) {
  Scene scene = sceneOfScale(1.0);
  scene.options.method = InjectionMethod::kDense;
  scene.options.denseSamples = 3;
  const Field expected = injectDense(scene.grid, emittersOf(scene).triangles, 3).intensity;
  EXPECT_EQ(relativeL2(injectedField(scene), expected), 0.0);
  scene.options.denseSamples = 4;
  EXPECT_GT(relativeL2(injectedField(scene), expected), 1e-3);
}

TEST(Pipeline, FollowsTheOptions) {
  Scene scene = sceneOfScale(1.0);
  const Field automatic = transportedField(scene);
  scene.options.iterations = 9;  // the longest dimension
  EXPECT_EQ(relativeL2(transportedField(scene), automatic), 0.0);
  scene.options.iterations = 10;
  EXPECT_GT(relativeL2(transportedField(scene), automatic), 1e-3);
  scene.options.iterations = 9;
  scene.options.clampFaces = true;
  EXPECT_GT(relativeL2(transportedField(scene), automatic), 1e-3);
}

// MATHS.md 1: |D| <= phi for every colour of every cell of the product, phi >= 0.
TEST(Pipeline, GivesWhatLightCanBe) {
  for (const auto& cell : transportedField(sceneOfScale(1.0)).cells) {
    for (const Coefficients& c : cell) {
      ASSERT_GE(fluenceOf(c), 0.0);
      ASSERT_LE(glm::length(vectorIrradianceOf(c)), fluenceOf(c) * (1.0 + 1e-14));
    }
  }
}

TEST(Pipeline, SumsLightsAndLeavesDisabledOnesOut) {
  Scene scene = sceneOfScale(1.0);
  scene.options.injection = Injection::kFlux;
  const Field one = injectedField(scene);
  auto off = std::make_shared<Light>(*scene.lights["light"]);
  off->enabled = false;
  scene.lights["off"] = off;
  EXPECT_EQ(relativeL2(injectedField(scene), one), 0.0);
  scene.lights["off"] = scene.lights["light"];
  Field twice = one;
  for (auto& cell : twice.cells) {
    for (Coefficients& c : cell) c *= 2.0;
  }
  EXPECT_LE(relativeL2(injectedField(scene), twice), 1e-14);
}

}  // namespace
}  // namespace lpv::reference
