// What a wall parts is two patches, and what stands on a floor parts nothing.
#include "scene/parted_patches.h"

#include <gtest/gtest.h>

#include <string>

#include "reference/meshes.h"
#include "shaders/layout.h"

namespace lpv {
namespace {

std::shared_ptr<Surface> addOwned(Scene& scene, const std::string& name, MeshPtr mesh) {
  auto out = std::make_shared<Surface>();
  out->name = name;
  out->mesh = std::move(mesh);
  scene.surfaces[name] = out;
  return out;
}

/// A closed room of 4 m whose walls reflect inwards.
Scene partedRoom() {
  Scene scene;
  scene.grid = {glm::dvec3(-2.25), 4.5 / 16.0, glm::ivec3(16)};
  addOwned(scene, "walls", reference::box(glm::dvec3(-2.0), glm::dvec3(2.0), true))->twoSided = false;
  return scene;
}

std::shared_ptr<Surface> addWall(Scene& scene, double z) {
  auto wall = addOwned(scene, "wall", reference::quad());
  wall->transform.translation.z = z;
  wall->transform.scale = glm::dvec3(4.2);
  return wall;
}

PatchedScene patchesOfWalls(const Scene& scene) {
  Scene walls = scene;
  std::erase_if(walls.surfaces, [](const auto& each) { return each.first != "walls"; });
  return {patchesOf(walls, 300), {}};
}

double areaOf(const std::vector<Patch>& patches, double from, double to) {
  double sum = 0.0;
  for (const Patch& p : patches) sum += double(p.position.z) > from && double(p.position.z) < to ? double(p.area) : 0.0;
  return sum;
}

// Broken by: places that stand for the whole triangle; areas that are not shared.
TEST(PartedPatches, AWallMakesTwoOfThoseBelowIt) {
  Scene scene = partedRoom();
  addWall(scene, 0.3);
  const PatchedScene before = patchesOfWalls(scene);
  const std::vector<Patch> after = parted(before, scene).patches;
  ASSERT_GT(after.size(), before.patches.size());
  std::size_t halves = 0;
  for (const Patch& p : after) {
    ASSERT_TRUE(p.triangle);
    if (p.places == kAllPlaces) continue;
    ++halves;
    int on[2] = {0, 0};
    for (int k = 0; k < layout::kPatchPlaces; ++k)
      if ((p.places >> k & 1U) == 1U) ++on[int(placeOfTriangle(p, k).z > 0.3)];
    EXPECT_TRUE(on[0] == 0 || on[1] == 0) << on[0] << " and " << on[1];
    EXPECT_GT(on[0] + on[1], 1);
    for (int i = 0; i < 64; ++i) {
      const glm::dvec3 place = ownPlace(p, {(i + 0.5) / 64.0, 0.5});
      EXPECT_EQ(place.z > 0.3, on[1] > 0);
    }
  }
  EXPECT_GE(halves, 2 * (after.size() - before.patches.size()));
  const double ring = 4.0 * 4.0;
  EXPECT_NEAR(areaOf(after, -1.99, 0.3), ring * 2.3, 0.03 * ring * 2.3);
  EXPECT_NEAR(areaOf(after, 0.3, 1.99), ring * 1.7, 0.03 * ring * 1.7);
}

// Broken by: panes that part nothing, through which light of another colour would come.
TEST(PartedPatches, APaneDoesToo) {
  Scene scene = partedRoom();
  auto pane = addWall(scene, 0.3);
  pane->alphaMode = AlphaMode::kBlend;
  pane->transmission = glm::dvec3(1.0, 0.0, 0.0);
  pane->opacity = 0.0;
  const PatchedScene before = patchesOfWalls(scene);
  EXPECT_GT(parted(before, scene).patches.size(), before.patches.size());
}

// Broken by: rays along the surface alone, which a ledge or a leg stops; sides that see nothing.
TEST(PartedPatches, WhatStandsOnThemDoesNot) {
  Scene scene = partedRoom();
  const PatchedScene before = patchesOfWalls(scene);
  EXPECT_EQ(parted(before, scene).patches.size(), before.patches.size()) << "nothing";
  addOwned(scene, "ledge", reference::box({-2.0, -2.0, 0.2}, {2.0, -1.9, 0.3}));
  addOwned(scene, "leg", reference::box({0.3, -2.0, -1.1}, {0.35, -1.2, -1.05}));
  addOwned(scene, "crate", reference::box({-1.3, -2.0, -1.3}, {-1.1, -1.8, -1.1}));
  for (const Patch& p : parted(before, scene).patches) EXPECT_EQ(p.places, kAllPlaces);
  EXPECT_EQ(parted(before, scene).patches.size(), before.patches.size());
}

// Broken by: no limit.
TEST(PartedPatches, AQuarterMoreAreTheMost) {
  Scene scene = partedRoom();
  for (int i = 0; i < 24; ++i) {
    auto wall = addOwned(scene, "wall " + std::to_string(i), reference::quad());
    wall->transform.translation.z = -1.9 + 0.16 * i;
    wall->transform.scale = glm::dvec3(4.2);
  }
  const PatchedScene before = patchesOfWalls(scene);
  const std::vector<Patch> after = parted(before, scene).patches;
  EXPECT_EQ(after.size(), before.patches.size() + before.patches.size() / 4);
}

}  // namespace
}  // namespace lpv
