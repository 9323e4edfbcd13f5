// What probes see of lights and of lit surfaces, on the CPU, against lights and surfaces in small pieces.
#include "scene/light_visibility.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/shadowed.h"
#include "reference/textures.h"
#include "scene/light_points.h"
#include "scene/reflected_light.h"
#include "scene/sh.h"

namespace lpv {
namespace {

Surface& placeSurface(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform) {
  auto surface = std::make_shared<Surface>();
  surface->name = name;
  surface->mesh = mesh;
  surface->transform = transform;
  scene.surfaces[name] = surface;
  return *surface;
}

Light& placeLight(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform) {
  auto light = std::make_shared<Light>();
  light->name = name;
  light->mesh = mesh;
  light->transform = transform;
  scene.lights[name] = light;
  return *light;
}

/// A lamp of 1 m, front down, 2 m above the origin; a plate of half a metre between them.
Scene plate() {
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  placeLight(scene, "lamp", reference::quad(), {{0.0, 0.0, 2.0}, rotationFromEulerDegrees({180.0, 0.0, 0.0})});
  placeSurface(scene, "plate", reference::quad(), {{0.1, 0.0, 1.0}, {1.0, 0.0, 0.0, 0.0}, glm::dvec3(0.5)});
  return scene;
}

std::shared_ptr<const Scene> asShared(const Scene& scene) { return std::make_shared<const Scene>(scene); }

std::vector<reference::Receiver> floorPoints() {
  std::vector<reference::Receiver> out;
  for (int x = -8; x <= 8; ++x) {
    for (int y = -8; y <= 8; ++y) out.push_back({{0.125 * x, 0.125 * y, 0.0}, {0.0, 0.0, 1.0}});
  }
  return out;
}

// Broken by: a bit for the whole light; rays to its middle.
TEST(LightVisibility, SharesFollowThePenumbra) {
  const Scene scene = plate();
  const LightVisibility visibility(asShared(scene));
  const reference::ShadowedLights truth(scene, 24);
  const auto emitters = reference::emittersOf(scene).triangles;
  double squares = 0.0, all = 0.0;
  int inBetween = 0;
  for (const reference::Receiver& r : floorPoints()) {
    const double open = reference::irradianceOf(emitters, r.position, r.normal).x;
    const double share = visibility.share(r.position, r.normal, 0).x, want = truth.irradiance(r).x;
    squares += std::pow(open * share - want, 2.0);
    all += want * want;
    inBetween += int(share > 0.05 && share < 0.95);
  }
  EXPECT_LE(std::sqrt(squares / all), 0.02);
  EXPECT_GT(inBetween, 100);
}

// A strip of the lamp beside a plate right below it, within a tenth: of the narrowest, 4,096 points have forty. Broken
// by: no more points than of a light that is seen as a whole.
TEST(LightVisibility, ALightThatIsNearlyHiddenSendsWhatIsLeft) {
  for (const double width : {0.01, 0.02, 0.03, 0.05}) {
    Scene scene;
    scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
    const auto down = rotationFromEulerDegrees({180.0, 0.0, 0.0});
    const Light& lamp = placeLight(scene, "lamp", reference::quad(), {{0.0, 0.0, 2.0}, down});
    placeSurface(scene, "plate", reference::quad(),
                 {{0.5, 0.0, 1.99}, {1.0, 0.0, 0.0, 0.0}, {2.0 - 2.0 * width, 3.0, 1.0}});
    const LightVisibility visibility(asShared(scene));
    for (const double x : {-0.7, -0.2, 0.4}) {
      const double edge = x + (-0.5 + width - x) * 2.0 / 1.99;  // of the plate, as it is seen on the lamp
      Light strip = lamp;
      strip.transform = {{0.5 * (edge - 0.5), 0.0, 2.0}, down, {edge + 0.5, 1.0, 1.0}};
      const auto at = [&](const Light& light) {
        return reference::irradianceOf(reference::emittersOf(scene.grid, light).triangles, {x, 0.1, 0.0}, {0, 0, 1}).x;
      };
      const double want = at(strip) / at(lamp);
      EXPECT_NEAR(visibility.share({x, 0.1, 0.0}, {0, 0, 1}, 0).x, want, 0.1 * want) << width << ' ' << x;
    }
  }
}

// Light with nothing in its way stays as it is, to the last bit.
TEST(LightVisibility, NothingInTheWayIsExactlyOne) {
  const LightVisibility visibility(asShared(plate()));
  EXPECT_EQ(visibility.share({0.0, 0.0, 1.2}, {0.0, 0.0, 1.0}, 0), glm::dvec3(1.0));
  EXPECT_EQ(visibility.share({1.9, 1.9, 0.0}, {0.0, 0.0, 1.0}, 0), glm::dvec3(1.0));
}

// Under the plate's middle, 5 cm below it.
TEST(LightVisibility, NothingArrivesRightBehindAPlate) {
  const LightVisibility visibility(asShared(plate()));
  EXPECT_EQ(visibility.share({0.1, 0.0, 0.95}, {0.0, 0.0, 1.0}, 0), glm::dvec3(0.0));
}

// A light counts among those that emit. Broken by: an index into all lights.
TEST(LightVisibility, LightsThatDoNotEmitAreNotCounted) {
  Scene scene = plate();
  placeLight(scene, "a first one that is off", reference::quad(), {}).enabled = false;
  placeLight(scene, "a second one that is black", reference::quad(), {}).radiance = glm::dvec3(0.0);
  const LightVisibility visibility(asShared(scene));
  EXPECT_EQ(visibility.share({0.1, 0.0, 0.95}, {0.0, 0.0, 1.0}, 0), glm::dvec3(0.0));
}

// A folded light stands in its own light, not in another's.
TEST(LightVisibility, ALightIsInItsOwnWayOnly) {
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  placeLight(scene, "folded", reference::bumpySphere(2000), {});
  placeLight(scene, "other", reference::quad(), {{0.0, 0.0, 1.5}, rotationFromEulerDegrees({180.0, 0.0, 0.0})});
  const LightVisibility visibility(asShared(scene));
  EXPECT_EQ(visibility.share({0.0, 0.0, -1.0}, {0.0, 0.0, 1.0}, 1), glm::dvec3(1.0));
  double least = 1.0;
  for (const reference::Receiver& r : floorPoints())
    least = std::min(least, visibility.share(r.position - glm::dvec3(0.0, 0.0, 0.6), r.normal, 0).x);
  EXPECT_LT(least, 0.99);
}

// Half of a screen is dark: hiding the other half hides all light. Broken by: the texture left out of the weights.
TEST(LightVisibility, SharesAreOfTheTexturesLight) {
  Scene scene = plate();
  auto lamp = std::make_shared<Light>(*scene.lights.at("lamp"));
  lamp->texture = reference::noise(4, 4);
  scene.lights["lamp"] = lamp;
  const LightVisibility visibility(asShared(scene));
  const glm::dvec3 share = visibility.share({0.1, 0.0, 0.0}, {0.0, 0.0, 1.0}, 0);
  EXPECT_NE(share.x, share.y);
  EXPECT_GT(share.x, 0.0);
  EXPECT_LT(share.x, 1.0);
}

TEST(LightPoints, StandForEqualAreas) {
  for (const MeshPtr& mesh :
       {reference::quad(), reference::sphere(), reference::tube(), reference::bumpySphere(2000)}) {
    const LightPoints points = lightPoints(*mesh, nullptr);
    ASSERT_FALSE(points.empty());
    double area = 0.0;
    for (const LightPoint& p : points) {
      EXPECT_NEAR(p.area, points[0].area, 1e-4 * double(points[0].area));
      EXPECT_NEAR(glm::length(p.normal), 1.0F, 1e-5F);
      area += double(p.area);
    }
    double want = 0.0;
    for (const glm::uvec3& t : mesh->triangles) {
      const auto& p = mesh->positions;
      want += 0.5 * double(glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x])));
    }
    EXPECT_NEAR(area, want, 1e-4 * want);
  }
}

// Every fourth one is a sample of the whole: its mean is the mean of all. Broken by: points in random order, too, but
// further off; by triangles in the order of the file.
TEST(LightPoints, EveryFourthIsASampleOfTheWhole) {
  for (const MeshPtr& mesh : {reference::quad(), reference::sphere(), reference::bumpySphere(2000)}) {
    const LightPoints points = lightPoints(*mesh, nullptr);
    glm::dvec3 all(0.0), some(0.0);
    for (std::size_t i = 0; i < points.size(); ++i) {
      all += glm::dvec3(points[i].position) / double(points.size());
      if (i % 4 == 2) some += 4.0 * glm::dvec3(points[i].position) / double(points.size());
    }
    EXPECT_LE(glm::length(all - some), 0.02);
  }
}

TEST(LightPoints, AMeshWithoutAreaHasNone) {
  Mesh mesh;
  mesh.positions = {glm::vec3(0.0F), glm::vec3(1.0F), glm::vec3(2.0F)};
  mesh.triangles = {{0, 1, 2}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  EXPECT_TRUE(lightPoints(mesh, nullptr).empty());
}

/// A wall of 2 x 2 m at z = 1, front down, that sends radiance 1 everywhere.
ReflectedLight litWall() {
  Scene scene;
  Surface& wall = placeSurface(scene, "wall", reference::quad(),
                               {{0.0, 0.0, 1.0}, rotationFromEulerDegrees({180.0, 0.0, 0.0}), glm::dvec3(2.0)});
  wall.twoSided = false;
  ReflectedLight light;
  light.of = std::make_shared<const PatchedScene>(PatchedScene{patchesOf(scene, 512), {}});
  light.radiance.assign(light.of->patches.size(), glm::dvec3(1.0));
  return light;
}

// As a light of the same radiance would; near the wall, too, where a patch is no point.
// Broken by: discs from near (.3 at a twentieth of a metre).
TEST(ReflectedLight, AWallIsALight) {
  const ReflectedLight wall = litWall();
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  placeLight(scene, "wall", reference::quad(),
             {{0.0, 0.0, 1.0}, rotationFromEulerDegrees({180.0, 0.0, 0.0}), glm::dvec3(2.0)});
  const auto emitters = reference::emittersOf(scene).triangles;
  for (const double z : {0.0, 0.5, 0.9, 0.95, 0.99}) {
    for (const double x : {0.0, 0.33, 0.8, 1.1}) {
      for (const glm::dvec3& n : {glm::dvec3(0.0, 0.0, 1.0), glm::normalize(glm::dvec3(-1.0, 0.0, 1.0))}) {
        const double want = reference::irradianceOf(emitters, {x, 0.1, z}, n).x;
        EXPECT_NEAR(wall.irradiance({x, 0.1, z}, n, nullptr).x, want, 0.01 * sh::kPi) << x << ' ' << z;
      }
    }
  }
}

// Half a wall behind a screen. Broken by: rays that are not sent.
TEST(ReflectedLight, WhatIsHiddenDoesNotCount) {
  const ReflectedLight wall = litWall();
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  placeSurface(scene, "screen", reference::quad(), {{1.0, 0.0, 0.5}, {1.0, 0.0, 0.0, 0.0}, {2.0, 8.0, 1.0}});
  const LightVisibility visibility(asShared(scene));
  const glm::dvec3 at(0.0), n(0.0, 0.0, 1.0);
  EXPECT_NEAR(wall.irradiance(at, n, &visibility).x, 0.5 * wall.irradiance(at, n, nullptr).x, 0.03);
}

}  // namespace
}  // namespace lpv
