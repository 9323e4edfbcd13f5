// What surfaces let through: panes, masks, their maps of alpha, and where else alpha counts.
#include "scene/transparency.h"

#include <gtest/gtest.h>

#include <random>

#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/light_visibility.h"
#include "scene/occluders.h"
#include "scene/patches.h"
#include "scene/raycast.h"
#include "scene/shadowing.h"

namespace lpv {
namespace {

constexpr double kOpacity = 0.25, kThrough = 1.0 - kOpacity;
const glm::dvec3 kRed(1.0, 0.0, 0.25);

/// A square of 1 m in z = 0 of `cuts` x `cuts` squares, or another mesh.
Surface pane(const MeshPtr& mesh = reference::quad()) {
  Surface out;
  out.name = "pane";
  out.mesh = mesh;
  out.alphaMode = AlphaMode::kBlend;
  out.opacity = kOpacity;
  out.transmission = kRed;
  return out;
}

/// Bars: of every four columns of texels the first covers.
TexturePtr bars(int size) {
  return reference::alphaTextureOf(size, size, [](int x, int) { return std::uint8_t(x % 4 == 0 ? 255 : 0); });
}

Surface grille(int texels) {
  Surface out;
  out.name = "grille";
  out.mesh = reference::quad();
  out.albedoTexture = bars(texels);
  out.alphaMode = AlphaMode::kMask;
  return out;
}

Scene sceneOf(const Surface& surface) {
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.25, glm::ivec3(16)};
  scene.surfaces[surface.name] = std::make_shared<Surface>(surface);
  return scene;
}

void expectNear(const glm::dvec3& got, const glm::dvec3& want, double within, const std::string& what = "") {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], within) << what << " " << c;
}

glm::dvec3 through(const Scene& scene, const glm::dvec3& from, const glm::dvec3& to) {
  return Occluders(scene).transmitted(from, to, kAllLights);
}

TEST(Transparency, APaneLetsItsShareThroughFromEitherSide) {
  const Scene scene = sceneOf(pane());
  expectNear(through(scene, {0.1, 0.2, 1}, {0.2, 0.1, -1}), kThrough * kRed, 1e-12);
  expectNear(through(scene, {0.1, 0.2, -1}, {0.2, 0.1, 1}), kThrough * kRed, 1e-12);
  expectNear(through(scene, {0.1, 0.2, 1}, {0.2, 0.1, 0.5}), glm::dvec3(1.0), 0.0);
  EXPECT_FALSE(Occluders(scene).blocked({0.1, 0.2, 1}, {0.2, 0.1, -1}, kAllLights));
}

// Red where both triangles of an edge count, or none.
TEST(Transparency, APaneIsOnePaneWhereItsTrianglesMeet) {
  constexpr int kCuts = 16;
  const Scene scene = sceneOf(pane(reference::quadOf(kCuts)));
  const Occluders occluders(scene);
  for (int i = 1; i < 2 * kCuts; ++i) {
    for (int k = 1; k < 2 * kCuts; ++k) {
      const double x = double(i) / (2 * kCuts) - 0.5, y = double(k) / (2 * kCuts) - 0.5;
      for (const double z : {1.0, -1.0})
        expectNear(occluders.transmitted({x, y, z}, {x, y, -z}, kAllLights), kThrough * kRed, 1e-12,
                   std::to_string(i) + ", " + std::to_string(k));
    }
  }
}

TEST(Transparency, ABoxOfGlassHasTwoFaces) {
  const Scene scene = sceneOf(pane(reference::box({-0.5, -0.5, -0.01}, {0.5, 0.5, 0.01})));
  expectNear(through(scene, {0.1, 0.2, 1}, {0.15, 0.1, -1}), kThrough * kThrough * kRed * kRed, 1e-12);
}

TEST(Transparency, PanesBehindOneAnotherMultiply) {
  Scene scene = sceneOf(pane());
  Surface other = pane();
  other.name = "other";
  other.transform.translation.z = -0.5;
  other.transmission = {0.5, 1.0, 1.0};
  scene.surfaces["other"] = std::make_shared<Surface>(other);
  expectNear(through(scene, {0.1, 0.2, 1}, {0.2, 0.1, -1}), kThrough * kThrough * kRed * glm::dvec3(0.5, 1.0, 1.0),
             1e-12);
}

TEST(Transparency, WhatLetsAllThroughIsNoOccluder) {
  Surface clear = pane();
  clear.opacity = 0.0;
  clear.transmission = glm::dvec3(1.0);
  Surface holes = grille(8);
  holes.alphaCutoff = 1.0;
  holes.opacity = 0.5;
  for (const Surface& surface : {clear, holes}) {
    EXPECT_TRUE(occludersOf(sceneOf(surface)).empty()) << surface.name;
    EXPECT_TRUE(coverageOf(surface).letsAllThrough()) << surface.name;
  }
  EXPECT_FALSE(canStop(clear));
  EXPECT_TRUE(canStop(pane()));
}

// Also what is opaque by its numbers costs what an opaque surface costs.
TEST(Transparency, OpaqueSurfacesHaveNoCoverage) {
  Surface surface = pane();
  surface.opacity = 1.0;
  EXPECT_EQ(occludersOf(sceneOf(surface)).at(0).coverage, Coverage());
  surface = pane();
  surface.alphaMode = AlphaMode::kOpaque;
  EXPECT_EQ(occludersOf(sceneOf(surface)).at(0).coverage, Coverage());
  EXPECT_TRUE(Occluders(sceneOf(surface)).blocked({0.1, 0.2, 1}, {0.2, 0.1, -1}, kAllLights));
  surface = grille(8);
  surface.alphaCutoff = 0.0;
  EXPECT_EQ(occludersOf(sceneOf(surface)).at(0).coverage, Coverage());
}

TEST(Transparency, AMaskCutsByTexel) {
  const Scene scene = sceneOf(grille(8));
  const Occluders occluders(scene);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-0.499, 0.499);
  for (int i = 0; i < 2000; ++i) {
    const double x = place(random), y = place(random);
    const int column = int((x + 0.5) * 8.0);
    expectNear(occluders.transmitted({x, y, 1}, {x, y, -1}, kAllLights), glm::dvec3(column % 4 == 0 ? 0.0 : 1.0), 0.0,
               std::to_string(x));
  }
}

// Red where a map takes single texels of a large texture.
TEST(Transparency, AMapHasTheMeanOfItsTexels) {
  const Coverage coverage = coverageOf(grille(2048));
  EXPECT_EQ(coverage.map->size, glm::ivec2(kMostAlphaBoxes));
  for (const double u : {0.1, 0.35, 0.9}) EXPECT_NEAR(coverage.map->at({u, 0.3}), 0.25, 1.0 / 255.0);
  EXPECT_NEAR(coverageOf(grille(8)).map->at({1.05, -0.7}), 1.0, 0.0) << "repeats";
}

TEST(Transparency, BlendedAlphaIsOpacityTimesTheTextures) {
  Surface surface = grille(8);
  surface.alphaMode = AlphaMode::kBlend;
  surface.opacity = 0.75;
  const Coverage coverage = coverageOf(surface);
  expectNear(coverage.through({0.05, 0.5}), glm::dvec3(0.25), 1e-12);
  expectNear(coverage.through({0.2, 0.5}), glm::dvec3(1.0), 1e-12);
}

TEST(Transparency, TheSameTextureAndThresholdHaveOneMap) {
  Surface surface = grille(8);
  const Coverage first = coverageOf(surface);
  EXPECT_EQ(coverageOf(surface).map, first.map);
  surface.opacity = 0.9;
  surface.alphaCutoff = 0.45;
  EXPECT_EQ(coverageOf(surface).map, first.map);
  surface.alphaCutoff = 0.1;
  EXPECT_NE(coverageOf(surface).map, first.map);
}

TEST(Transparency, SurfacesReflectAlphaTimesAlbedo) {
  Surface surface = pane();
  surface.albedo = {0.5, 0.25, 1.0};
  for (const Patch& p : patchesOf(sceneOf(surface), 16))
    expectNear(glm::dvec3(p.albedo), kOpacity * surface.albedo, 1e-6);
  surface = grille(64);
  surface.albedo = glm::dvec3(0.8);
  const std::vector<Patch> patches = patchesOf(sceneOf(surface), 1);
  ASSERT_FALSE(patches.empty());
  glm::dvec3 sum(0.0);
  for (const Patch& p : patches) sum += glm::dvec3(p.albedo) / double(patches.size());
  EXPECT_LE(sum.x, 0.8);
  surface.alphaMode = AlphaMode::kOpaque;
  for (const Patch& p : patchesOf(sceneOf(surface), 1)) expectNear(glm::dvec3(p.albedo), glm::dvec3(0.8), 1e-6);
  surface = pane();
  surface.opacity = 0.0;
  EXPECT_TRUE(patchesOf(sceneOf(surface), 16).empty());
}

TEST(Transparency, PixelsAreAskedThroughPanesAndHoles) {
  Scene scene = sceneOf(grille(8));
  Surface wall = pane(reference::quadOf(1));
  wall.name = "wall";
  wall.alphaMode = AlphaMode::kOpaque;
  wall.transform.translation.z = -1.0;
  scene.surfaces["wall"] = std::make_shared<Surface>(wall);
  EXPECT_EQ(raycast(scene, {-0.45, 0.1, 1}, {0, 0, -1})->object, "grille");
  EXPECT_EQ(raycast(scene, {-0.3, 0.1, 1}, {0, 0, -1})->object, "wall");
  Surface glass = pane();
  glass.transform.translation.z = 0.5;
  for (const double opacity : {0.49, 0.51}) {
    glass.opacity = opacity;
    scene.surfaces["pane"] = std::make_shared<Surface>(glass);
    EXPECT_EQ(raycast(scene, {-0.3, 0.1, 1}, {0, 0, -1})->object, opacity < 0.5 ? "wall" : "pane");
  }
}

TEST(Transparency, ProbesSeeALightThroughAPane) {
  Scene scene = sceneOf(pane());
  auto light = std::make_shared<Light>();
  light->name = "light";
  light->mesh = reference::quad();
  light->transform.translation.z = -1.0;
  light->transform.scale = glm::dvec3(0.1);
  scene.lights["light"] = light;
  EXPECT_FALSE(shadowsPossible(scene)) << "nothing is behind the pane";
  Surface wall = pane();
  wall.name = "wall";
  wall.alphaMode = AlphaMode::kOpaque;
  wall.transform.translation.z = 0.75;
  scene.surfaces["wall"] = std::make_shared<Surface>(wall);
  EXPECT_TRUE(shadowsPossible(scene));
  const LightVisibility visibility(std::make_shared<Scene>(scene));
  expectNear(visibility.share({0, 0, 0.5}, {0, 0, -1}, 0), kThrough * kRed, 1e-9);
  expectNear(visibility.seen({0, 0, 0.5}, {0, 0, -1}, {0.1, 0, -0.5}), kThrough * kRed, 1e-9);
}

}  // namespace
}  // namespace lpv
