// Pieces of folds are finer where lights are near, and as they were elsewhere.
#include "scene/piece_sizes.h"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "reference/meshes.h"

namespace lpv {
namespace {

/// A bar of 2 m along x, 10 cm thick, and a floor so large that one patch stands for all of the bar.
Scene barOnFloor() {
  Scene scene;
  auto floor = std::make_shared<Surface>();
  floor->name = "floor";
  floor->twoSided = false;
  floor->mesh = reference::quad();
  floor->transform.scale = glm::dvec3(20.0);
  scene.surfaces["floor"] = floor;
  auto bar = std::make_shared<Surface>();
  bar->name = "bar";
  bar->twoSided = false;
  bar->mesh = reference::box(glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(2.0, 0.1, 1.1), false);
  scene.surfaces["bar"] = bar;
  return scene;
}

/// A panel of 10 cm in 64 points, `distance` before the bar's end at x = 0, which it faces.
LightInPoints panel(float distance, float brightness = 5.0F) {
  LightInPoints out;
  out.brightness = double(brightness);
  const glm::vec3 normal(1.0F, 0.0F, 0.0F);
  for (int i = 0; i < 64; ++i) {
    const glm::vec3 at(-distance, (float(i % 8) + 0.5F) / 80.0F, 1.0F + (float(i / 8) + 0.5F) / 80.0F);
    out.points.push_back({at, 0.01F / 64.0F, normal, normal});
  }
  return out;
}

PieceSizes sizesFor(const std::vector<LightInPoints>& lights) { return pieceSizesNear(lights, barOnFloor(), 0.04); }

Folds foldsWith(const PieceSizes& sizes) { return patchedScene(barOnFloor(), 64, 1024, sizes).folds; }

double areaOf(const Folds& folds) {
  double sum = 0.0;
  for (const Patch& p : folds.pieces) sum += double(p.area);
  return sum;
}

/// Of the pieces of the bar's end at x = 0, or of the other one: the largest.
double largestAt(const Folds& folds, float x) {
  double out = 0.0;
  for (const Patch& p : folds.pieces) {
    if (p.position.x == x) out = std::max(out, double(p.area));
  }
  return out;
}

// Broken by: sizes of another triangle; pieces that are cut and not all kept.
TEST(PieceSizesTest, AreSmallBeforeALightAndTileTheSame) {
  const Folds coarse = foldsWith({}), fine = foldsWith(sizesFor({panel(0.05F)}));
  EXPECT_GT(largestAt(coarse, 0.0F), 0.025 * 0.025);
  EXPECT_LE(largestAt(fine, 0.0F), 0.025 * 0.025) << "half as wide as the light is far";
  EXPECT_EQ(largestAt(fine, 2.0F), largestAt(coarse, 2.0F)) << "the other end";
  EXPECT_NEAR(areaOf(fine), areaOf(coarse), 1e-5);
  EXPECT_GT(fine.pieces.size(), coarse.pieces.size() + 16U);
}

// Broken by: lights that send to both sides where they have one; lights of any brightness.
TEST(PieceSizesTest, AreAsTheyWereWhereNoLightCounts) {
  EXPECT_EQ(sizesFor({}), PieceSizes());
  EXPECT_EQ(sizesFor({panel(3.0F)}), PieceSizes()) << "far";
  LightInPoints turned = panel(0.05F);
  for (LightPoint& p : turned.points) p.direction = -p.direction;
  EXPECT_EQ(sizesFor({turned}), PieceSizes()) << "its back to the bar";
  turned.twoSided = true;
  EXPECT_NE(sizesFor({turned}), PieceSizes());
  EXPECT_EQ(sizesFor({panel(3.0F), panel(0.05F, 0.1F)}), PieceSizes()) << "dim beside a bright one";
}

// Broken by: sizes that follow distances without steps.
TEST(PieceSizesTest, StayWhereALightMovesALittle) {
  EXPECT_EQ(sizesFor({panel(0.05F)}), sizesFor({panel(0.0501F)}));
  EXPECT_NE(sizesFor({panel(0.05F)}), sizesFor({panel(0.01F)}));
}

// Broken by: as many pieces as lights ask for.
TEST(PieceSizesTest, AreNoMoreThanThreeTimesAsMany) {
  Scene scene = barOnFloor();
  for (int i = 0; i < 20; ++i) {
    auto bar = std::make_shared<Surface>(*scene.surfaces.at("bar"));
    bar->transform.translation.y = 0.2 * i;
    bar->transform.scale = glm::dvec3(0.05, 1.0, 1.0);
    scene.surfaces["bar " + std::to_string(i)] = bar;
  }
  std::vector<LightInPoints> lights;
  for (int i = 0; i < 20; ++i) {
    lights.push_back(panel(0.01F));
    for (LightPoint& p : lights.back().points) p.position.y += 0.2F * float(i);
  }
  const PieceSizes sizes = pieceSizesNear(lights, scene, 0.04);
  ASSERT_NE(sizes, PieceSizes());
  const std::size_t coarse = patchedScene(scene, 64, 1024).folds.pieces.size();
  const std::size_t fine = patchedScene(scene, 64, 1024, sizes).folds.pieces.size();
  EXPECT_GT(fine, coarse);
  EXPECT_LE(fine, 3U * 1024U);
}

}  // namespace
}  // namespace lpv
