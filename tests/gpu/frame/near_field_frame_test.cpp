// The near field of streams' frames (FrameRequest::reduced): lights are looked at from some pixels, and the picture is
// the one that looks at them from each.

#include <algorithm>
#include <cmath>

#include "gpu/engine/engine_rig.h"
#include "reference/textures.h"

namespace lpv {
namespace {

constexpr int kWidth = 160, kHeight = 120;

struct Frames {
  FramePtr full, reduced;
};

class NearFieldFrameTest : public test::EngineTest {
 protected:
  Frames frames(const Scene& scene, const Camera& camera, SessionKey session = 1,
                const glm::ivec2& size = {kWidth, kHeight}) {
    TickRequest request = test::requestOf(scene, session);
    request.frames = {test::linearFrame(camera, size), test::linearFrame(camera, size)};
    request.frames[1].reduced = true;
    const TickResult result = run(request);
    return result.frames.size() == 2 ? Frames{result.frames[0], result.frames[1]} : Frames{};
  }
};

/// RMS of the difference as a share of the mean.
double nrmse(const Frames& f) {
  double squares = 0.0, sum = 0.0;
  for (std::size_t i = 0; i < f.full->rgb32f.size(); ++i) {
    const double apart = double(f.reduced->rgb32f[i]) - double(f.full->rgb32f[i]);
    squares += apart * apart;
    sum += double(f.full->rgb32f[i]);
  }
  const double count = double(f.full->rgb32f.size());
  return std::sqrt(squares / count) / (sum / count);
}

/// Largest difference of a pixel as a share of the full one; the floor is a tenth of the mean.
double worst(const Frames& f) {
  double sum = 0.0, worst = 0.0;
  for (const float v : f.full->rgb32f) sum += double(v);
  const double floor = 0.1 * sum / double(f.full->rgb32f.size());
  for (std::size_t i = 0; i < f.full->rgb32f.size(); ++i) {
    const double full = f.full->rgb32f[i], apart = std::abs(double(f.reduced->rgb32f[i]) - full);
    worst = std::max(worst, apart / std::max(full, floor));
  }
  return worst;
}

/// GATHER in cells of .2 m about the origin, the floor 6 x 6 m at z = -.5; the light is to be placed.
Scene floorWith(const MeshPtr& mesh, const glm::dvec3& at) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.visibility = Visibility::kOff;  // shadows look at the lights everywhere
  scene.grid = {glm::dvec3(-2.0), 0.2, glm::ivec3(20)};
  Light& light = test::lightOf(scene);
  light.mesh = mesh;
  light.transform.translation = at;
  Surface& floor = test::addSurface(scene, "floor", reference::quad());
  floor.transform.scale = glm::dvec3(6.0);
  floor.transform.translation.z = -0.5;
  return scene;
}

/// Upright, its front towards -y.
Surface& addWall(Scene& scene, const std::string& name, double y) {
  Surface& wall = test::addSurface(scene, name, reference::quad());
  wall.transform.rotation = rotationFromEulerDegrees({90.0, 0.0, 0.0});
  wall.transform.scale = glm::dvec3(4.0);
  wall.transform.translation = {0.0, y, 0.0};
  return wall;
}

Camera cameraAt(const glm::dvec3& eye, const glm::dvec3& target) {
  Camera camera;
  camera.eye = eye;
  camera.target = target;
  camera.up = {0.0, 0.0, 1.0};
  camera.fovDegrees = 45.0;
  return camera;
}

Scene lampNearFloor() {
  Scene scene = floorWith(reference::sphere(), {0.1, 0.05, -0.2});
  test::lightOf(scene).transform.scale = glm::dvec3(0.3);
  return scene;
}

Scene statueBeforeWall() {
  Scene scene = floorWith(reference::bumpySphere(2000), {0.0, 0.0, 0.0});
  test::lightOf(scene).transform.scale = glm::dvec3(0.5);
  addWall(scene, "wall", 0.45);
  return scene;
}

Scene texturedScreen() {
  Scene scene = floorWith(reference::quad(), {0.0, 0.3, 0.0});
  Light& light = test::lightOf(scene);
  light.transform.rotation = rotationFromEulerDegrees({90.0, 0.0, 0.0});
  light.texture = reference::noise(8, 8);
  addWall(scene, "wall", 0.35);
  return scene;
}

// What the full frame is within itself of the truth is near_field_test.cpp's. Broken by: a linear interpolation that
// asks for nothing; points of one tile that go to another's pixels.
TEST_F(NearFieldFrameTest, ReducedFramesAreWithinAPercent) {
  const Camera camera = cameraAt({1.3, -1.7, 0.9}, {0.0, 0.1, -0.2});
  EXPECT_LE(nrmse(frames(lampNearFloor(), camera, 1)), 0.01) << "lamp";
  EXPECT_LE(nrmse(frames(statueBeforeWall(), camera, 2)), 0.01) << "statue";
  EXPECT_LE(nrmse(frames(texturedScreen(), camera, 3)), 0.01) << "screen";
}

// And it is sampled at all: no frame is the full one. Broken by: FrameRequest::reduced not read.
TEST_F(NearFieldFrameTest, ReducedFramesAreNotTheFullOnes) {
  const Frames f = frames(lampNearFloor(), cameraAt({1.3, -1.7, 0.9}, {0.0, 0.1, -0.2}));
  EXPECT_NE(f.full->rgb32f, f.reduced->rgb32f);
}

/// 9 % in single pixels beside the line where the floor goes behind a light's plane: E has a kink there.
constexpr double kAtKinks = 0.12;

// Two planes at 90 degrees, of which the light sees one far better. Every pixel counts.
// Broken by: no comparison of normals.
TEST_F(NearFieldFrameTest, ACornerDoesNotBleed) {
  Scene scene = floorWith(reference::quad(), {0.0, 0.1, -0.1});
  Light& light = test::lightOf(scene);
  light.transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 0.0});
  light.transform.scale = glm::dvec3(0.5);
  addWall(scene, "wall", 0.4);
  EXPECT_LE(worst(frames(scene, cameraAt({0.6, -1.5, 0.5}, {0.0, 0.4, -0.4}))), kAtKinks);
}

// A slat of a few pixels in front of a wall that is as upright as it is, and dimmer. Broken by: no comparison of depth.
TEST_F(NearFieldFrameTest, AThinObjectDoesNotBleed) {
  Scene scene = floorWith(reference::quad(), {0.0, -0.5, -0.2});
  Light& light = test::lightOf(scene);
  light.transform.rotation = rotationFromEulerDegrees({-90.0, 0.0, 0.0});
  light.transform.scale = glm::dvec3(0.4);
  addWall(scene, "wall", -0.1);
  Surface& slat = addWall(scene, "slat", -0.3);
  slat.transform.scale = {0.02, 1.0, 1.0};
  slat.transform.translation.x = 0.285;  // between the columns that are evaluated whatever is around them
  EXPECT_LE(worst(frames(scene, cameraAt({0.3, -1.9, 0.6}, {0.0, 0.2, 0.0}))), kAtKinks);
}

// Whatever the size, to the last row and column. Broken by: pixels outside the last whole tile or block left alone.
TEST_F(NearFieldFrameTest, AnySize) {
  const Camera camera = cameraAt({1.3, -1.7, 0.9}, {0.0, 0.1, -0.2});
  SessionKey session = 1;
  for (const glm::ivec2& size : {glm::ivec2(16, 16), glm::ivec2(61, 47), glm::ivec2(129, 33)})
    EXPECT_LE(nrmse(frames(lampNearFloor(), camera, session++, size)), 0.01) << size.x << " x " << size.y;
}

// Lights are followed, and the same scene gives the same bytes whatever was shown before.
// Broken by: points of the frame before; tiles that were near once.
TEST_F(NearFieldFrameTest, TheSameSceneGivesTheSameBytes) {
  Scene scene = lampNearFloor();
  const Camera camera = cameraAt({1.3, -1.7, 0.9}, {0.0, 0.1, -0.2});
  const FramePtr first = frames(scene, camera).reduced;
  test::lightOf(scene).transform.translation += glm::dvec3(0.4, -0.3, 0.1);
  const FramePtr moved = frames(scene, camera).reduced;
  EXPECT_NE(moved->rgb32f, first->rgb32f);
  EXPECT_EQ(frames(scene, camera, 2).reduced->rgb32f, moved->rgb32f);
  test::lightOf(scene).transform.translation -= glm::dvec3(0.4, -0.3, 0.1);
  EXPECT_EQ(frames(scene, camera).reduced->rgb32f, first->rgb32f);
}

// More polygons and trees than one light has. Broken by: another light's radiance; rounds of polygons counted fourfold.
TEST_F(NearFieldFrameTest, ManyLights) {
  Scene scene = lampNearFloor();
  for (int i = 0; i < 60; ++i) {
    auto light = std::make_shared<Light>(*scene.lights.at("light"));
    light->mesh = i % 3 == 0 ? reference::quadOf(4) : i % 3 == 1 ? reference::pyramid() : reference::sphere();
    light->transform.scale = glm::dvec3(0.15);
    light->transform.translation = {0.25 * (i % 8) - 1.0, 0.3 * int(i / 8) - 1.0, -0.2};
    light->radiance = glm::dvec3(1.0, i % 2, i % 5);
    light->twoSided = i % 4 == 0;
    scene.lights["light " + std::to_string(i)] = light;
  }
  const Frames f = frames(scene, cameraAt({1.3, -1.7, 0.9}, {0.0, 0.1, -0.2}), 1, {96, 72});
  EXPECT_LE(nrmse(f), 0.01);
}

}  // namespace
}  // namespace lpv
