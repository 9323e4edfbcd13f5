// What a light emits and what a scene covers.
#include "scene/scene.h"

#include <gtest/gtest.h>

#include "reference/emitter.h"
#include "reference/meshes.h"

namespace lpv {
namespace {

std::shared_ptr<Light> poweredLight(const MeshPtr& mesh) {
  auto light = std::make_shared<Light>();
  light->mesh = mesh;
  light->power = glm::dvec3(12.0, 6.0, 0.0);
  return light;
}

TEST(EmittedRadiance, IsTheGivenOneWithoutPower) {
  Light light;
  light.mesh = reference::quad();
  light.radiance = {1, 2, 3};
  light.transform.scale = glm::dvec3(9.0);
  EXPECT_EQ(emittedRadiance(light), glm::dvec3(1, 2, 3));
}

// A flat square of 1 m^2 and radiance L emits pi L.
TEST(EmittedRadiance, IsPowerOverPiArea) {
  const auto light = poweredLight(reference::quad());
  EXPECT_NEAR(emittedRadiance(*light).x, 12.0 / 3.14159265358979, 1e-12);
  light->twoSided = true;
  EXPECT_NEAR(emittedRadiance(*light).y, 3.0 / 3.14159265358979, 1e-12);
}

TEST(EmittedRadiance, EqualsTheReferenceUnderEveryTransform) {
  const auto light = poweredLight(reference::sphere());
  light->transform.scale = {0.5, -2.0, 3.0};
  light->transform.rotation = rotationFromEulerDegrees({10, 200, -70});
  light->transform.translation = {100, 200, 300};
  const glm::dvec3 mine = reference::radianceOf(*light);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(emittedRadiance(*light)[c], mine[c], 1e-12 * mine.x);
}

TEST(EmittedRadiance, OfAMeshWithoutAreaIsNone) {
  Mesh mesh;
  mesh.positions.resize(3, glm::vec3(1.0F));
  mesh.triangles = {{0, 1, 2}};
  const auto light = poweredLight(std::make_shared<const Mesh>(mesh));
  EXPECT_EQ(emittedRadiance(*light), glm::dvec3(0.0));
}

TEST(ContentBounds, CoverSurfacesAndEnabledLights) {
  Scene scene;
  EXPECT_TRUE(contentBounds(scene).empty());
  auto surface = std::make_shared<Surface>();
  surface->mesh = reference::box(glm::dvec3(-1), glm::dvec3(1));
  surface->transform.translation = {0, 5, 0};
  scene.surfaces["box"] = surface;
  auto light = poweredLight(reference::quad());
  light->transform.translation = {10, 0, 0};
  light->transform.scale = {2, 4, 1};
  scene.lights["square"] = light;
  EXPECT_EQ(contentBounds(scene).min, glm::dvec3(-1, -2, -1));
  EXPECT_EQ(contentBounds(scene).max, glm::dvec3(11, 6, 1));
  auto off = std::make_shared<Light>(*light);
  off->enabled = false;
  scene.lights["square"] = off;
  EXPECT_EQ(contentBounds(scene).max.x, 1.0);
}

}  // namespace
}  // namespace lpv
