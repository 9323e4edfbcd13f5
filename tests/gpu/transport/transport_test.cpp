// From lights to volume through the engine, against the whole chain in double.

#include "gpu/engine/engine_rig.h"
#include "reference/compare.h"
#include "reference/pipeline.h"
#include "reference/volume.h"

namespace lpv {
namespace {

class TransportTest : public test::EngineTest {
 protected:
  /// Both fields of a scene against the reference; single precision and fixed point allow 1e-4 of the norm (goal 1e-6).
  void compare(const Scene& scene) {
    TickRequest request = test::requestOf(scene);
    request.transported = request.injected = true;
    const TickResult result = run(request);
    ASSERT_NE(result.injected, nullptr);
    EXPECT_LE(reference::relativeL2(reference::fieldOf(*result.injected), reference::injectedField(scene)), 1e-4);
    EXPECT_LE(reference::relativeL2(reference::fieldOf(*result.transported), reference::transportedField(scene)), 1e-4);
  }
};

TEST_F(TransportTest, OneLight) { compare(test::smallScene()); }

TEST_F(TransportTest, LightsOfThreeColoursOneTwoSidedOneByPower) {
  Scene scene = test::smallScene();
  for (int i = 0; i < 3; ++i) {
    auto light = std::make_shared<Light>(*scene.lights.at("light"));
    light->mesh = i == 0 ? reference::quad() : i == 1 ? reference::pyramid() : reference::tube();
    light->radiance = glm::dvec3(i == 0, i == 1, 2.0);
    light->transform.translation = {0.7 * i - 0.9, 0.5, -0.4 * i};
    light->transform.rotation = glm::angleAxis(0.4 + i, glm::normalize(glm::dvec3(1, 1 + i, 2)));
    light->transform.scale = glm::dvec3(1.0, i == 1 ? -0.7 : 0.7, 0.5);
    light->twoSided = i == 0;
    if (i == 2) light->power = glm::dvec3(3.0, 2.0, 9.0);
    scene.lights["light " + std::to_string(i)] = light;
  }
  compare(scene);
}

TEST_F(TransportTest, ClampedFacesAndFewIterationsInALongGrid) {
  Scene scene = test::smallScene();
  scene.grid = {glm::dvec3(-2.0, -0.6, -0.7), 0.13, glm::ivec3(31, 9, 12)};
  scene.options.clampFaces = true;
  scene.options.iterations = 5;
  compare(scene);
}

TEST_F(TransportTest, ALightPartlyOutside) {
  Scene scene = test::smallScene();
  test::lightOf(scene).transform.translation = {1.9, -1.9, 2.05};
  compare(scene);
}

TEST_F(TransportTest, AnUntouchedGridFarAway) {
  Scene scene = test::smallScene();
  test::lightOf(scene).transform.translation = {1e6, 0.0, 0.0};
  scene.grid.origin += glm::dvec3(1e6, 0.0, 0.0);
  compare(scene);
}

}  // namespace
}  // namespace lpv
