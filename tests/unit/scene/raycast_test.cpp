// Pick's ray against the reference renderer: what a pixel shows is what a ray through it finds.
#include "scene/raycast.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/meshes.h"
#include "reference/render.h"
#include "reference/room.h"

namespace lpv {
namespace {

std::string nameOf(const Scene& scene, int object) {
  const int lights = int(scene.lights.size());
  if (object < lights) return std::next(scene.lights.begin(), object)->first;
  return std::next(scene.surfaces.begin(), object - lights)->first;
}

Scene sceneWith(const std::shared_ptr<Light>& light) {
  Scene scene;
  scene.lights["light"] = light;
  return scene;
}

std::shared_ptr<Light> squareLight() {
  auto light = std::make_shared<Light>();
  light->mesh = reference::quad();
  return light;
}

// Red when mirrored or one-sided surfaces, the order of objects or the nearest of several hits go wrong.
TEST(Raycast, FindsWhatEachPixelShows) {
  Scene room = reference::smallRoom();
  auto turned = std::make_shared<Surface>(*room.surfaces["tall"]);
  turned->transform.scale.x *= -1.0;
  turned->twoSided = false;
  room.surfaces["tall"] = turned;
  const Camera camera = reference::roomCamera();
  const reference::Picture picture = reference::render(room, Volume(), camera, {.width = 48, .height = 27});
  const double aspect = 48.0 / 27.0;
  for (int y = 0; y < picture.height; ++y) {
    for (int x = 0; x < picture.width; ++x) {
      const reference::Seen& seen = picture.seen[picture.index(x, y)];
      const glm::dvec3 ray = camera.rayDirection((x + 0.5) / 48.0, (y + 0.5) / 27.0, aspect);
      const std::optional<Hit> hit = raycast(room, camera.eye, ray);
      ASSERT_EQ(hit.has_value(), seen.object >= 0) << x << ", " << y;
      if (!hit) continue;
      EXPECT_EQ(hit->object, nameOf(room, seen.object)) << x << ", " << y;
      EXPECT_EQ(hit->isLight, seen.object == 0);
      EXPECT_NEAR(glm::dot(hit->position - camera.eye, glm::normalize(camera.target - camera.eye)), seen.depth, 1e-12);
      EXPECT_NEAR(glm::dot(hit->normal, seen.normal), 1.0, 1e-12);  // no vertex normals in the room
      EXPECT_NEAR(glm::length(hit->position - camera.eye), hit->distance, 1e-12);
    }
  }
}

TEST(Raycast, FindsALightFromBehindButNotADisabledOne) {
  const auto light = squareLight();
  const std::optional<Hit> hit = raycast(sceneWith(light), {0.1, 0.1, -2}, {0, 0, 1});
  ASSERT_TRUE(hit);
  EXPECT_EQ(hit->object, "light");
  EXPECT_EQ(hit->normal, glm::dvec3(0, 0, -1));  // towards the ray's origin
  light->enabled = false;
  EXPECT_FALSE(raycast(sceneWith(light), {0.1, 0.1, -2}, {0, 0, 1}));
}

TEST(Raycast, InsideABoxFindsTheWallAheadNotTheOneBehind) {
  auto walls = std::make_shared<Surface>();
  walls->mesh = reference::box({-1, -2, -3}, {4, 5, 6}, true);
  walls->twoSided = false;
  Scene scene;
  scene.surfaces["walls"] = walls;
  EXPECT_NEAR(raycast(scene, {0.1, 0.2, 0.3}, {1, 0, 0})->distance, 3.9, 1e-12);
  EXPECT_NEAR(raycast(scene, {0.1, 0.2, 0.3}, {0, 0, -1})->distance, 3.3, 1e-12);
  walls->twoSided = true;
  EXPECT_NEAR(raycast(scene, {0.1, 0.2, 0.3}, {0, 1, 0})->distance, 4.8, 1e-12);
}

TEST(Raycast, MissesWhatIsBehindBesideOrParallel) {
  const Scene scene = sceneWith(squareLight());
  EXPECT_FALSE(raycast(scene, {0, 0, 1}, {0, 0, 1}));
  EXPECT_FALSE(raycast(scene, {0.6, 0, 1}, {0, 0, -1}));
  EXPECT_FALSE(raycast(scene, {-2, 0, 0}, {1, 0, 0}));
  EXPECT_FALSE(raycast(Scene(), {0, 0, 0}, {0, 0, 1}));
}

}  // namespace
}  // namespace lpv
