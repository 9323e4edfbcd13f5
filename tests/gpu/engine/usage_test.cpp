// What the smallest scene with default settings asks of the device: features that it does not need cost it nothing.

#include "gpu/usage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/support/gl_test.h"
#include "lpv/pipeline.h"
#include "reference/meshes.h"
#include "scene/error_goal.h"

namespace lpv {
namespace {

/// A quad of 1 m over a floor of 4 m, in the grid that the server fits.
Scene smallest() {
  Scene scene;
  auto light = std::make_shared<Light>();
  light->name = "light";
  light->mesh = reference::quad();
  light->transform.translation = {0.0, 0.0, 2.0};
  light->transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 0.0});
  scene.lights["light"] = light;
  auto floor = std::make_shared<Surface>();
  floor->name = "floor";
  floor->mesh = reference::quad();
  floor->transform.scale = glm::dvec3(4.0);
  scene.surfaces["floor"] = floor;
  scene.options = resolved({});
  scene.grid = *gridFor({}, contentBounds(scene));
  return scene;
}

class UsageTest : public test::GlTest {};

/// A session of its own.
class Ticks {
 public:
  gpu::Usage tick(const Scene& scene, bool frame, bool volume) {
    TickRequest request;
    request.scene = std::make_shared<Scene>(scene);
    request.transported = volume;
    if (frame) {
      request.frames.resize(1);
      request.frames[0].view = 1;
      request.frames[0].reduced = reduced;
      request.frames[0].size = {64, 64};
      request.frames[0].camera.eye = {0.0, -3.0, 1.5};
      request.frames[0].camera.target = {0.0, 0.0, 0.0};
    }
    const gpu::Usage before = gpu::usage();
    TickResult result;
    GpuTask story = pipeline_.tick(state_, request, result);
    story.runToEnd();
    const gpu::Usage after = gpu::usage();
    return {after.dispatches - before.dispatches, after.objects - before.objects, after.bytes - before.bytes};
  }

  bool reduced = false;  ///< frames are a stream's

 private:
  Pipeline pipeline_{10.0};  // nothing is cut into pieces
  SessionState state_;
};

void expectUsage(const gpu::Usage& got, const gpu::Usage& want, const char* what) {
  EXPECT_EQ(got.dispatches, want.dispatches) << what;
  EXPECT_EQ(got.objects, want.objects) << what;
  EXPECT_EQ(got.bytes, want.bytes) << what;
}

// What it was before lights had grids of their own, fields guards and lights groups in every quality, and one dispatch,
// whose length the device knows, for triangles that snapping makes a segment.
// Broken by: a guard for every scene; groups for one light.
TEST_F(UsageTest, OfTheSmallestScene) {
  Scene scene = smallest();
  Ticks session;
  expectUsage(session.tick(scene, true, false), {25, 29, 500372}, "first frame");
  expectUsage(session.tick(scene, true, false), {2, 1, 4}, "the same again");
  auto moved = std::make_shared<Light>(*scene.lights["light"]);
  moved->transform.translation.x = 0.3;
  scene.lights["light"] = moved;
  expectUsage(session.tick(scene, true, false), {25, 3, 388}, "moved");
  expectUsage(session.tick(scene, false, true), {2, 3, 886272}, "a volume");
}

// With shadows a stream looks again at the light that moved, and at no other.
// Broken by: pools of lights that are looked at together.
TEST_F(UsageTest, OfAStreamWithShadows) {
  Scene scene = smallest();
  scene.options.visibility = Visibility::kOn;
  scene.options.bounces = 0;
  const auto addLight = [&scene](const std::string& name, double x) {
    auto light = std::make_shared<Light>(*scene.lights.at("light"));
    light->name = name;
    light->transform.translation.x = x;
    scene.lights[name] = light;
  };
  for (const char* name : {"a", "b", "c"}) addLight(name, 0.2);
  Ticks session;
  session.reduced = true;
  session.tick(scene, true, false);
  const auto dispatchesOf = [&](std::initializer_list<const char*> moved) {
    for (const char* name : moved) addLight(name, scene.lights.at(name)->transform.translation.x + 0.1);
    return session.tick(scene, true, false).dispatches;
  };
  const auto none = dispatchesOf({}), one = dispatchesOf({"b"}), all = dispatchesOf({"a", "b", "c", "light"});
  EXPECT_LT(none, one);
  EXPECT_NEAR(double(all - none), 4.0 * double(one - none), 8.0);
}

}  // namespace
}  // namespace lpv
