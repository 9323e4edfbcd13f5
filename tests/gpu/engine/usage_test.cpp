// What the smallest scene with default settings asks of the device: features that it does not need cost it nothing.

#include "gpu/usage.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "gpu/account.h"
#include "gpu/buffer.h"
#include "gpu/support/gl_test.h"
#include "gpu/texture.h"
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
    memory = result.report.memory;
    const gpu::Usage after = gpu::usage();
    return {after.dispatches - before.dispatches, after.objects - before.objects, after.bytes - before.bytes};
  }

  bool reduced = false;  ///< frames are a stream's
  MemoryUse memory;      ///< after the last tick

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

// Volumes alone of one light in 32^3 cells take no more than 8 MiB, and nothing for frames; frames have an account of
// their own.
// Broken by: shadows, bounces or textures for who reads volumes; frames charged to the light.
TEST_F(UsageTest, MemoryOfASession) {
  Scene scene = smallest();
  scene.surfaces.clear();
  scene.grid = {glm::dvec3(-2.0), 4.0 / 32.0, glm::ivec3(32)};
  Ticks volumes;
  volumes.tick(scene, false, true);
  EXPECT_GT(volumes.memory.light, 32 * 32 * 32 * 12 * 4) << "the volume and its copy";
  EXPECT_LE(volumes.memory.light, 8 << 20);
  EXPECT_EQ(volumes.memory.frames, 0);
  EXPECT_GE(volumes.memory.scene, 4 * 12 + 4 * 8 + 2 * 12) << "vertices and triangles";
  Ticks frames;
  frames.tick(smallest(), true, false);
  EXPECT_GT(frames.memory.frames, 64 * 64 * (8 + 4 + 4 + 16)) << "G-buffer and emission";
}

// Broken by: a move that forgets to take the charge along.
TEST_F(UsageTest, WhatIsLetGoOfIsNotCharged) {
  const auto account = std::make_shared<gpu::Account>();
  gpu::chargeTo(account);
  {
    gpu::Buffer buffer("a", 100);
    gpu::Buffer other = std::move(buffer);
    gpu::Texture texture = gpu::Texture::make2d("b", {4, 4}, GL_RGBA16F, gpu::Sampling::kNearestClamp);
    EXPECT_EQ(account->bytes, 100 + 128);
    texture = gpu::Texture::make2d("c", {4, 4}, GL_RGBA32F, gpu::Sampling::kMipmapRepeat, 3);
    EXPECT_EQ(account->bytes, 100 + 16 * (16 + 4 + 1));
    gpu::chargeTo(nullptr);
    other = gpu::Buffer("d", 1000);
    EXPECT_EQ(account->bytes, 16 * (16 + 4 + 1));
  }
  EXPECT_EQ(account->bytes, 0);
}

}  // namespace
}  // namespace lpv
