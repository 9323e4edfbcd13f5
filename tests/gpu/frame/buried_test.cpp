// Pixels at creases: what they show is lit from in front of both surfaces that meet there.

#include <algorithm>

#include "gpu/engine/engine_rig.h"
#include "gpu/frame/light_views.h"
#include "scene/transform.h"

namespace lpv {
namespace {

using test::pixel;

class BuriedTest : public test::EngineTest {
 protected:
  FramePtr frame(const Scene& scene, const FrameRequest& request) {
    TickRequest tick = test::requestOf(scene, 1);
    tick.frames = {request};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
};

/// 3 m across, to whose front the way from its middle is turned about y from z.
void addPanel(Scene& scene, const std::string& name, double radiance, const glm::dvec3& at, double turned) {
  auto light = std::make_shared<Light>(test::lightOf(scene));
  light->mesh = reference::quad();
  light->radiance = glm::dvec3(radiance);
  light->visibleToCamera = false;
  light->transform = {at, rotationFromEulerDegrees({0.0, turned, 0.0}), glm::dvec3(3.0)};
  scene.lights[name] = light;
}

/// Two walls that meet in a valley along y, dimly lit from in front and very brightly from behind, as their neighbours
/// face.
Scene valley() {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.visibility = Visibility::kOn;
  scene.options.bounces = 0;
  for (const double side : {-1.0, 1.0}) {
    Surface& wall = test::addSurface(scene, side < 0.0 ? "left" : "right", reference::quad());
    wall.transform = {{side * std::sqrt(2.0), 0.0, std::sqrt(2.0)},
                      rotationFromEulerDegrees({0.0, -45.0 * side, 0.0}),
                      glm::dvec3(4.0)};
    wall.twoSided = true;
  }
  addPanel(scene, "in front", 1.0, {0.0, 0.0, 8.0}, 180.0);
  addPanel(scene, "behind the left", 1000.0, {-3.5, 0.0, 0.0}, 90.0);
  addPanel(scene, "behind the right", 1000.0, {3.5, 0.0, 0.0}, -90.0);
  scene.lights.erase("light");
  return scene;
}

// The crease goes through the middles of a column of pixels, a little askew, so that rows see it by hundredths of a
// millimetre to their left and right. Rasterizers know it to a tenth: a pixel is 65 mm wide. The camera goes through a
// step of theirs. Broken by: a pass that is left out; rays that begin where a pixel was drawn.
TEST_F(BuriedTest, APixelAtACreaseIsNotLitFromBehind) {
  constexpr int kSide = 33, kSteps = 12;
  const Scene scene = valley();
  Camera camera;
  camera.fovDegrees = 30.0;
  camera.up = {5e-4, 1.0, 0.0};
  const double pixelAcross = 2.0 * 4.0 * std::tan(glm::radians(15.0)) / kSide;
  double brightest = 0.0, beside = 0.0;
  for (int i = 0; i < kSteps; ++i) {
    const double moved = pixelAcross / 256.0 * i / kSteps;
    camera.eye = {moved, 0.0, 4.0};
    camera.target = {moved, 0.0, 0.0};
    const FramePtr picture = frame(scene, test::linearFrame(camera, {kSide, kSide}));
    ASSERT_EQ(picture->size, glm::ivec2(kSide));
    for (int y = 0; y < kSide; ++y) {
      brightest = std::max<double>(brightest, pixel(*picture, kSide / 2, y).x);
      beside = std::max<double>(beside, pixel(*picture, kSide / 2 - 1, y).x);
    }
  }
  EXPECT_GT(beside, 0.0);
  EXPECT_LT(brightest, 1.5 * beside);
}

}  // namespace
}  // namespace lpv
