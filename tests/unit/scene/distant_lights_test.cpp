// Lights so far away that their directions are the same everywhere: how they are cut up and placed.
#include "scene/distant_lights.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/default_view.h"
#include "scene/raycast.h"

namespace lpv {
namespace {

constexpr double kPi = std::numbers::pi;

MeshPtr sky() {
  Mesh mesh = skyMesh();
  EXPECT_TRUE(finishMesh(mesh).ok());
  return std::make_shared<const Mesh>(std::move(mesh));
}

/// The texture coordinates of a direction, by the definition in scene.proto.
glm::dvec2 uvOf(const glm::dvec3& d) { return {0.5 + std::atan2(d.z, d.x) / (2.0 * kPi), 0.5 - std::asin(d.y) / kPi}; }

/// 512 x 256 texels of 1, and of `bright` where they are within so many degrees of a direction.
TexturePtr pictureWithSun(const glm::dvec3& towards, double degrees, float bright) {
  return reference::textureOf(512, 256, [&](int x, int y) {
    const double azimuth = 2.0 * kPi * ((x + 0.5) / 512 - 0.5), polar = kPi * (y + 0.5) / 256;
    const glm::dvec3 d(std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth));
    return glm::dvec3(glm::dot(d, towards) > std::cos(glm::radians(degrees)) ? double(bright) : 1.0);
  });
}

const glm::dvec3 kSun = glm::normalize(glm::dvec3(0.3, 0.8, -0.5));

Light skyLight(const TexturePtr& picture = nullptr) {
  Light light;
  light.name = "sky";
  light.mesh = sky();
  light.texture = picture;
  light.distant = true;
  return light;
}

Grid gridOf(const glm::dvec3& origin, double cell) { return {origin, cell, glm::ivec3(16)}; }

// Broken by: a winding turned over; u that runs the other way.
TEST(SkyMesh, IsASphereThatEmitsInwardsAndShowsThePicture) {
  const MeshPtr mesh = sky();
  EXPECT_NEAR(mesh->area, 4.0 * kPi, 0.03);
  EXPECT_EQ(degenerateTriangles(*mesh), 0U);
  for (const glm::uvec3& t : mesh->triangles) {
    const glm::dvec3 a(mesh->positions[t.x]), b(mesh->positions[t.y]), c(mesh->positions[t.z]);
    ASSERT_LT(glm::dot(glm::cross(b - a, c - a), a + b + c), 0.0);
    const glm::dvec3 middle = glm::normalize(a + b + c);
    const glm::dvec2 uv = (glm::dvec2(mesh->uvs[t.x]) + glm::dvec2(mesh->uvs[t.y]) + glm::dvec2(mesh->uvs[t.z])) / 3.0;
    ASSERT_NEAR(uv.x, uvOf(middle).x, 0.01);
    ASSERT_NEAR(uv.y, uvOf(middle).y, 0.01);
  }
}

// Broken by: a triangle left out of its part.
TEST(DistantParts, AreAllOfTheMesh) {
  const MeshPtr mesh = sky();
  for (const TexturePtr& picture : {TexturePtr(), pictureWithSun(kSun, 3.0, 1000.0F)}) {
    const auto parts = distantParts(mesh, picture);
    ASSERT_EQ(parts->size(), kMostDistantParts);
    std::size_t triangles = 0;
    double area = 0.0;
    for (const DistantPart& part : *parts) {
      triangles += part.mesh->triangles.size();
      area += part.mesh->area;
      EXPECT_EQ(part.mesh->uvs.size(), part.mesh->positions.size());
    }
    EXPECT_EQ(triangles, mesh->triangles.size());
    EXPECT_NEAR(area, mesh->area, 1e-6);
  }
  EXPECT_EQ(distantParts(mesh, nullptr), distantParts(mesh, nullptr)) << "not kept";
}

// An even sky is cut into eights, the sun out of one that has it. Broken by: halves by area alone.
TEST(DistantParts, AreSmallWhereTheLightIs) {
  const MeshPtr mesh = sky();
  const auto even = distantParts(mesh, nullptr);
  for (const DistantPart& part : *even) {
    EXPECT_GT(part.mesh->area, 0.08 * mesh->area);
    EXPECT_LT(part.mesh->area, 0.2 * mesh->area);
  }
  const auto parts = distantParts(mesh, pictureWithSun(kSun, 3.0, 10000.0F));
  double least = 1.0;
  for (const DistantPart& part : *parts) {
    for (const LightPoint& p : *part.points) {
      if (p.factor.x > 100.0F) least = std::min(least, part.mesh->area / mesh->area);
    }
  }
  EXPECT_LT(least, 0.12);
}

// The points' areas are what sums over them are weighed with. Broken by: areas as if points were spread evenly; points
// by area alone, of which few meet the sun.
TEST(DistantParts, PointsStandForAreaAndPower) {
  const MeshPtr mesh = sky();
  constexpr double kDegrees = 3.0, kBright = 1000.0;
  double area = 0.0, power = 0.0;
  std::size_t points = 0, ofSun = 0;
  const auto parts = distantParts(mesh, pictureWithSun(kSun, kDegrees, float(kBright)));
  for (const DistantPart& part : *parts) {
    double ofPart = 0.0;
    for (const LightPoint& p : *part.points) {
      ofPart += double(p.area);
      power += double(p.area) * double(p.factor.x);
      ofSun += p.factor.x > 0.5F * float(kBright) ? 1 : 0;
      EXPECT_LT(glm::dot(glm::dvec3(p.normal), glm::dvec3(p.position)), 0.0);
    }
    EXPECT_NEAR(ofPart, part.mesh->area, 0.02 * part.mesh->area);
    area += ofPart;
    points += part.points->size();
  }
  const double sun = 2.0 * kPi * (1.0 - std::cos(glm::radians(kDegrees)));
  EXPECT_NEAR(area, 4.0 * kPi, 0.02 * 4.0 * kPi);
  EXPECT_NEAR(power, 4.0 * kPi + (kBright - 1.0) * sun, 0.05 * (4.0 * kPi + kBright * sun));
  EXPECT_GT(ofSun, 300U) << "of " << points;
}

TEST(PlaceDistantLights, PutsPartsAroundTheGrid) {
  const auto source = std::make_shared<const Light>(skyLight());
  std::map<std::string, LightPtr> lights = {{"sky", source}, {"lamp", std::make_shared<Light>()}};
  const Grid grid = gridOf({-1.0, 0.0, 2.0}, 0.25);
  placeDistantLights(lights, grid);
  ASSERT_EQ(lights.size(), 1 + kMostDistantParts);
  EXPECT_FALSE(lights.contains("sky"));
  Bounds box;
  for (const auto& [name, light] : lights) {
    if (name == "lamp") continue;
    EXPECT_EQ(sessionName(name, *light), "sky");
    EXPECT_EQ(name, light->name);
    EXPECT_FALSE(light->castsShadow);
    box.add(light->mesh->bounds.transformed(light->transform.worldFromObject()));
  }
  const double radius = kDistance * 0.5 * glm::length(grid.bounds().extent());
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(box.centre()[axis], grid.bounds().centre()[axis], 1e-3 * radius);
    EXPECT_NEAR(box.extent()[axis], 2.0 * radius, 0.01 * radius);
  }
}

// What did not change stays the same object, so that nothing is made again. Broken by: parts placed at every call.
TEST(PlaceDistantLights, LeavesWhatStands) {
  std::map<std::string, LightPtr> lights = {{"sky", std::make_shared<const Light>(skyLight())}};
  placeDistantLights(lights, gridOf({0.0, 0.0, 0.0}, 0.25));
  const auto before = lights;
  placeDistantLights(lights, gridOf({0.0, 0.0, 0.0}, 0.25));
  EXPECT_EQ(lights, before);
  placeDistantLights(lights, gridOf({0.0, 0.0, 0.0}, 0.5));
  EXPECT_NE(lights, before);
  EXPECT_EQ(lights.size(), before.size());
  EXPECT_EQ(lights.begin()->second->mesh, before.begin()->second->mesh);
  eraseParts(lights, "sky");
  EXPECT_TRUE(lights.empty());
}

// Broken by: a share of each part's area for its power.
TEST(PlaceDistantLights, KeepsASunWhole) {
  Light sun;
  sun.name = "sun";
  sun.mesh = reference::quad();  // half a degree across
  sun.distant = true;
  sun.transform = {{0.0, 1.0, 0.0}, rotationFromEulerDegrees({90.0, 0.0, 0.0}), glm::dvec3(0.01)};
  sun.radiance = {4.0, 2.0, 1.0};
  std::map<std::string, LightPtr> lights = {{"sun", std::make_shared<const Light>(sun)}};
  placeDistantLights(lights, gridOf({0.0, 0.0, 0.0}, 0.25));
  ASSERT_EQ(lights.size(), 1U);
  const Light& placed = *lights.at("sun/1");
  EXPECT_EQ(emittedRadiance(placed), sun.radiance);
  EXPECT_EQ(placed.mesh->triangles.size(), 2U);
}

// Neither the content's bounds nor the view go by what is at infinity.
TEST(PlaceDistantLights, IsNoContent) {
  Scene scene;
  scene.grid = gridOf({-2.0, -2.0, -2.0}, 0.25);
  auto floor = std::make_shared<Surface>();
  floor->name = "floor";
  floor->mesh = reference::quad();
  scene.surfaces["floor"] = floor;
  const Bounds without = contentBounds(scene);
  const Camera view = DefaultView(scene).camera(1.5);
  scene.lights["sky"] = std::make_shared<const Light>(skyLight());
  placeDistantLights(scene.lights, scene.grid);
  EXPECT_EQ(contentBounds(scene), without);
  EXPECT_EQ(DefaultView(scene).camera(1.5).eye, view.eye);
  const auto hit = raycast(scene, {0.0, 0.0, 1.0}, {0.0, 0.0, 1.0});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->object, "sky");
}

}  // namespace
}  // namespace lpv
