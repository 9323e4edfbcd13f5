// Where a scene is looked at from when nobody says.
#include "scene/default_view.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/meshes.h"
#include "scene/occupancy.h"

namespace lpv {
namespace {

constexpr double kWide = 16.0 / 9.0;

void put(Scene& scene, const MeshPtr& mesh) {
  auto surface = std::make_shared<Surface>();
  surface->mesh = mesh;
  scene.surfaces["s" + std::to_string(scene.surfaces.size())] = surface;
}

/// A parallelogram.
MeshPtr wall(const glm::dvec3& at, const glm::dvec3& u, const glm::dvec3& v) {
  Mesh mesh;
  mesh.positions = {at, at + u, at + u + v, at + v};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  EXPECT_TRUE(finishMesh(mesh).ok());
  return std::make_shared<const Mesh>(std::move(mesh));
}

struct Room {
  bool front = true;    ///< a wall at z = size.z
  bool content = true;  ///< something in the middle
};

/// A square of .4 m that shines along `down`, or against it.
void putLamp(Scene& scene, const glm::dvec3& at, double down) {
  auto light = std::make_shared<Light>();
  light->mesh = wall(at, {0.4 * down, 0, 0}, {0, 0, 0.4});
  scene.lights["l" + std::to_string(scene.lights.size())] = light;
}

/// A box from the origin to `size`.
Scene box(const glm::dvec3& size, const Room& room) {
  Scene scene;
  const glm::dvec3 x(size.x, 0, 0);
  const glm::dvec3 y(0, size.y, 0);
  const glm::dvec3 z(0, 0, size.z);
  put(scene, wall({}, x, z));
  put(scene, wall(y, x, z));
  put(scene, wall({}, y, z));
  put(scene, wall(x, y, z));
  put(scene, wall({}, x, y));
  if (room.front) put(scene, wall(z, x, y));
  if (room.content) put(scene, wall(size * 0.45, x * 0.1, y * 0.1));
  return scene;
}

bool within(const glm::dvec3& p, const Bounds& bounds) {
  return glm::all(glm::greaterThan(p, bounds.min)) && glm::all(glm::lessThan(p, bounds.max));
}

TEST(DefaultView, IsInsideARoomAlongItsLongestAxis) {
  const Camera camera = DefaultView(box({4, 3, 9}, {})).camera(kWide);
  EXPECT_TRUE(checkCamera(camera).ok());
  EXPECT_TRUE(within(camera.eye, {{0, 0, 0}, {4, 3, 9}}));
  EXPECT_GT(std::abs(glm::normalize(camera.target - camera.eye).z), 0.9);
}

TEST(DefaultView, InsideARoomDoesNotDependOnThePicture) {
  const DefaultView view(box({9, 3, 4}, {}));
  EXPECT_EQ(view.camera(kWide), view.camera(0.5));
  EXPECT_GT(std::abs(glm::normalize(view.camera(1.0).target - view.camera(1.0).eye).x), 0.9);
}

TEST(DefaultView, LooksThroughAnOpenSide) {
  const DefaultView view(box({2, 2, 2}, {.front = false}));
  const Camera camera = view.camera(4.0 / 3.0);
  EXPECT_GT(camera.eye.z, 3.0);
  EXPECT_LT(glm::distance(glm::normalize(camera.target - camera.eye), glm::dvec3(0, 0, -1)), 1e-9);
  EXPECT_GT(view.camera(0.5).eye.z, camera.eye.z + 1.0) << "a narrow picture needs more distance";
}

TEST(DefaultView, LooksAtThingsFromOutside) {
  const Scene empty = box({1, 1, 1}, {.content = false});
  EXPECT_EQ(DefaultView(empty).camera(1.0), defaultCamera(contentBounds(empty)));
  Scene ball;
  put(ball, reference::sphere());
  EXPECT_EQ(DefaultView(ball).camera(1.0), defaultCamera(contentBounds(ball)));
}

TEST(DefaultView, IsWhereTheLightIs) {
  for (const glm::dvec3& size : {glm::dvec3(4, 3, 5), glm::dvec3(60, 2.5, 2)}) {
    Scene lit = box(size, {.content = false});
    putLamp(lit, {0.5 * size.x, size.y - 0.01, 0.4 * size.z}, 1.0);
    EXPECT_TRUE(within(DefaultView(lit).camera(kWide).eye, {{0, 0, 0}, size})) << size.x;
    Scene outside = box(size, {.content = false});
    putLamp(outside, {0.5 * size.x, size.y, 0.4 * size.z}, -1.0);
    EXPECT_EQ(DefaultView(outside).camera(kWide), defaultCamera(contentBounds(outside))) << "it shines upwards";
  }
}

// Every side of something flat is "covered", and so is its inside.
TEST(DefaultView, OfAFloorIsFromAbove) {
  Scene floor;
  put(floor, wall({}, {9, 0, 0}, {0, 0, 6}));
  EXPECT_GT(DefaultView(floor).camera(kWide).eye.y, 1.0);
}

TEST(DefaultView, SeesLightsThatAreOn) {
  Scene scene;
  auto light = std::make_shared<Light>();
  light->mesh = reference::sphere();
  light->transform.translation = {50, 0, 0};
  scene.lights["on"] = light;
  auto off = std::make_shared<Light>(*light);
  off->transform.translation = {-1000, 0, 0};
  off->enabled = false;
  scene.lights["off"] = off;
  EXPECT_EQ(DefaultView(scene).camera(kWide), defaultCamera(contentBounds(scene)));
  EXPECT_NEAR(DefaultView(scene).camera(kWide).target.x, 50.0, 1.0);
}

TEST(DefaultView, OfNothingIsAValidCamera) {
  EXPECT_TRUE(checkCamera(DefaultView().camera(kWide)).ok());
  EXPECT_EQ(DefaultView(Scene()).camera(kWide), DefaultView().camera(kWide));
}

TEST(Occupancy, HoldsEveryPieceOfATriangle) {
  Scene scene;
  put(scene, wall({0, 0, 0}, {1, 0, 0}, {0, 1, 0}));
  put(scene, wall({0, 0, 1}, {0.1, 0, 0}, {0, 0.1, 0}));
  const Occupancy grid(scene, 10);
  EXPECT_EQ(grid.dims(), glm::ivec3(10));
  for (int y = 0; y < 10; ++y) {
    for (int x = 0; x < 10; ++x) EXPECT_TRUE(grid.at({x, y, 0})) << x << "," << y;
  }
  EXPECT_FALSE(grid.at({5, 5, 5}));
  EXPECT_NEAR(grid.freeDistance({0.55, 0.55, 0.95}, {0, 0, -1}), 0.85, 0.1);
  EXPECT_NEAR(grid.freeDistance({0.55, 0.55, 0.55}, {0, 0, 1}), 0.45, 0.1);
}

// Walls across the whole scene, too many to visit each of their points: a thin triangle is found nevertheless.
TEST(Occupancy, LooksLessCloselyAtVeryMuch) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int i = 0; i < 200'000; ++i) mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {0, 2, 3}});
  mesh.triangles.push_back({0, 1, 4});
  ASSERT_TRUE(finishMesh(mesh).ok());
  Scene scene;
  put(scene, std::make_shared<const Mesh>(std::move(mesh)));
  const Occupancy grid(scene, 48);
  EXPECT_TRUE(grid.at({0, 0, 47}));
}

}  // namespace
}  // namespace lpv
