// Where lights are near to a surface its patches are finer, and nowhere else.
#include "scene/patches_near_lights.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/meshes.h"

namespace lpv {
namespace {

/// A closed room of 4 m whose walls reflect inwards.
Scene room() {
  Scene scene;
  auto walls = std::make_shared<Surface>();
  walls->name = "walls";
  walls->twoSided = false;
  walls->mesh = reference::box(glm::dvec3(-2.0), glm::dvec3(2.0), true);
  scene.surfaces["walls"] = walls;
  return scene;
}

/// A panel of `size` that faces along +z or, turned, along -z, in 64 points.
LightInPoints panelAt(const glm::vec3& middle, float size, bool turned) {
  LightInPoints out;
  out.brightness = 5.0;
  const glm::vec3 normal(0.0F, 0.0F, turned ? -1.0F : 1.0F);
  for (int i = 0; i < 64; ++i) {
    const glm::vec3 at((float(i % 8) - 3.5F) / 8.0F, (float(i / 8) - 3.5F) / 8.0F, 0.0F);
    out.points.push_back({middle + size * at, size * size / 64.0F, normal, normal});
  }
  return out;
}

std::vector<std::uint32_t> halvingsFor(const std::vector<Patch>& patches, const LightInPoints& light) {
  return halvingsNearLights(patches, {light}, 512);
}

// Broken by: distances that are measured from a light's middle alone; lights that send to both sides where they have
// one.
TEST(PatchesNearLights, AreAsTheyWereWhereNoLightShinesClose) {
  const std::vector<Patch> patches = patchesOf(room(), 1000);
  EXPECT_TRUE(halvingsFor(patches, panelAt({0.0F, 0.0F, 0.0F}, 0.5F, false)).empty()) << "in the middle";
  EXPECT_TRUE(halvingsFor(patches, panelAt({0.0F, 0.0F, 1.95F}, 0.5F, true)).empty()) << "its back to the wall";
  EXPECT_FALSE(halvingsFor(patches, panelAt({0.0F, 0.0F, 1.95F}, 0.5F, false)).empty()) << "its front";
  LightInPoints both = panelAt({0.0F, 0.0F, 1.95F}, 0.5F, true);
  both.twoSided = true;
  EXPECT_FALSE(halvingsFor(patches, both).empty());
}

// Broken by: halves that are not written back; a queue by number.
TEST(PatchesNearLights, AreFineBeforeALightAndTileWhatTheyTiled) {
  PatchedScene before;
  before.patches = patchesOf(room(), 1000);
  const std::vector<std::uint32_t> halvings = halvingsFor(before.patches, panelAt({0.3F, 0.2F, 1.96F}, 0.5F, false));
  const std::vector<Patch> after = halved(before, halvings).patches;
  ASSERT_EQ(after.size(), before.patches.size() + halvings.size());
  double area = 0.0;
  float largest = 0.0F;
  for (const Patch& p : after) {
    area += double(p.area);
    const auto& c = *p.triangle;
    EXPECT_NEAR(glm::dot(p.normal, glm::cross(c[1] - c[0], c[2] - c[0])), 2.0F * p.area, 1e-5F);
    const glm::vec2 from = glm::abs(glm::vec2(p.position) - glm::vec2(0.3F, 0.2F));
    if (p.position.z > 1.99F && std::max(from.x, from.y) < 0.2F) largest = std::max(largest, p.area);
  }
  EXPECT_NEAR(area, 96.0, 1e-3);
  EXPECT_LE(largest, 0.02F) << "of a tenth of a square metre, 4 cm before a panel";
  for (std::size_t i = 0; i < before.patches.size(); ++i) {
    if (std::ranges::find(halvings, std::uint32_t(i)) == halvings.end()) {
      EXPECT_EQ(after[i].position, before.patches[i].position) << i;
    }
  }
}

TEST(PatchesNearLights, AreNoMoreThanAllowed) {
  const std::vector<Patch> patches = patchesOf(room(), 1000);
  EXPECT_EQ(halvingsNearLights(patches, {panelAt({0.13F, 0.07F, 1.97F}, 2.0F, false)}, 40).size(), 40U);
}

// The share of all light counts: a candle beside a wall is nothing where a lamp lights the room.
TEST(PatchesNearLights, AreThoseOfLightsThatMatter) {
  const std::vector<Patch> patches = patchesOf(room(), 1000);
  LightInPoints lamp = panelAt({0.0F, 0.0F, 0.0F}, 1.0F, false), candle = panelAt({0.0F, 0.0F, 1.98F}, 0.02F, false);
  EXPECT_TRUE(halvingsNearLights(patches, {lamp, candle}, 512).empty());
  EXPECT_FALSE(halvingsNearLights(patches, {candle}, 512).empty());
}

}  // namespace
}  // namespace lpv
