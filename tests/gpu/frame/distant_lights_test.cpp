// The sky as a light, against closed forms: frames and probes, open and beside a wall, and what cameras see of it.
#include "scene/distant_lights.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "gpu/engine/engine_rig.h"
#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/emitter_list.h"
#include "scene/lookup.h"

namespace lpv {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kAlbedo = 0.5;
constexpr double kFloor = 1.8;  ///< half its edge, metres
const glm::dvec3 kUp(0.0, 0.0, 1.0);

/// Radiance in the direction d: brighter towards the axes, red along x, green along y, blue along z.
glm::dvec3 slope(const glm::dvec3& d) { return 1.0 + 0.5 * d; }
/// What a surface with that normal gets of it: bands 0 and 1 of a clamped cosine.
glm::dvec3 irradianceOfSlope(const glm::dvec3& n) { return kPi * (1.0 + 0.5 * 2.0 / 3.0 * n); }

glm::dvec3 directionAt(double u, double v) {
  const double azimuth = 2.0 * kPi * (u - 0.5), polar = kPi * v;
  return {std::sin(polar) * std::cos(azimuth), std::cos(polar), std::sin(polar) * std::sin(azimuth)};
}

TexturePtr slopePicture() {
  return reference::textureOf(256, 128,
                              [](int x, int y) { return slope(directionAt((x + 0.5) / 256, (y + 0.5) / 128)); });
}

/// 20^3 cells of .2 m about the origin, lit by the sky alone.
Scene openScene(const TexturePtr& picture = nullptr, const glm::dquat& rotation = glm::dquat(1.0, 0.0, 0.0, 0.0)) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.transport = Transport::kGather;
  scene.options.bounces = 0;
  scene.grid = {glm::dvec3(-2.0), 0.2, glm::ivec3(20)};
  Mesh mesh = skyMesh();
  EXPECT_TRUE(finishMesh(mesh).ok());
  Light sky;
  sky.name = "sky";
  sky.mesh = std::make_shared<const Mesh>(std::move(mesh));
  sky.texture = picture;
  sky.distant = true;
  sky.radiance = glm::dvec3(1.0);
  sky.transform.rotation = rotation;
  scene.lights = {{"sky", std::make_shared<const Light>(sky)}};
  placeDistantLights(scene.lights, scene.grid);
  return scene;
}

Surface& addFloor(Scene& scene) {
  Surface& floor = test::addSurface(scene, "floor", reference::quad());
  floor.transform.scale = glm::dvec3(2.0 * kFloor);
  floor.albedo = glm::dvec3(kAlbedo);
  return floor;
}

class DistantLightsTest : public test::EngineTest {
 protected:
  /// E at the floor's pixels, and where they are.
  struct Seen {
    glm::dvec3 at, e;
  };
  std::vector<Seen> floorOf(const Scene& scene, bool reduced = false) {
    Camera camera;
    camera.eye = {0.0, 0.0, 2.0};
    camera.target = glm::dvec3(0.0);
    camera.up = {0.0, 1.0, 0.0};
    camera.fovDegrees = 80.0;
    TickRequest request = test::requestOf(scene);
    request.frames = {test::linearFrame(camera)};
    request.frames[0].reduced = reduced;
    const TickResult result = run(request);
    std::vector<Seen> out;
    if (result.frames.empty()) return out;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        const glm::dvec3 ray = camera.rayDirection((x + 0.5) / 64.0, (y + 0.5) / 64.0, 1.0);
        const glm::dvec3 at = camera.eye - camera.eye.z / ray.z * ray;
        if (std::max(std::abs(at.x), std::abs(at.y)) > kFloor - 0.1) continue;
        out.push_back({at, kPi / kAlbedo * test::pixel(*result.frames[0], x, y)});
      }
    }
    EXPECT_GT(out.size(), 1000U);
    return out;
  }
};

/// Root of the mean square over that of the truth.
double errorOf(const std::vector<std::pair<glm::dvec3, glm::dvec3>>& gotAndWant) {
  double wrong = 0.0, all = 0.0;
  for (const auto& [got, want] : gotAndWant) {
    wrong += glm::dot(got - want, got - want);
    all += glm::dot(want, want);
  }
  return std::sqrt(wrong / all);
}

// Within what the opening rule leaves: 1.1 % too little, 1.7 in streams. Broken by: parts that share a tree; a winding
// that emits outwards.
TEST_F(DistantLightsTest, AnEvenSkyGivesPiTimesItsRadiance) {
  Scene scene = openScene();
  addFloor(scene);
  for (const bool reduced : {false, true}) {
    for (const auto& seen : floorOf(scene, reduced))
      ASSERT_NEAR(seen.e.x, kPi, 0.02 * kPi) << seen.at.x << " " << seen.at.y;
  }
}

// Broken by: a picture turned about y, or seen in a mirror; a rotation that is left out.
TEST_F(DistantLightsTest, ThePictureIsWhereItBelongs) {
  for (const glm::dvec3& degrees : {glm::dvec3(0.0), glm::dvec3(0.0, 90.0, 0.0), glm::dvec3(-90.0, 0.0, 30.0)}) {
    const glm::dquat rotation = rotationFromEulerDegrees(degrees);
    Scene scene = openScene(slopePicture(), rotation);
    addFloor(scene);
    const glm::dvec3 want = irradianceOfSlope(glm::inverse(rotation) * kUp);
    std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs;
    for (const auto& seen : floorOf(scene)) pairs.emplace_back(seen.e, want);
    EXPECT_LT(errorOf(pairs), 0.01) << degrees.x << " " << degrees.y;
  }
}

// In a volume, as clients look it up.
TEST_F(DistantLightsTest, ProbesInTheOpenGetWhatTheirNormalsSee) {
  const Scene scene = openScene(slopePicture());
  TickRequest request = test::requestOf(scene);
  request.transported = request.probed = true;
  const TickResult result = run(request);
  ASSERT_NE(result.transported, nullptr);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs;
  for (int i = 0; i < 60; ++i) {
    const double z = (i + 0.5) / 30.0 - 1.0, azimuth = 2.399963 * i, r = std::sqrt(1.0 - z * z);
    const glm::dvec3 n(r * std::cos(azimuth), r * std::sin(azimuth), z), at(0.3 * n.y, 0.7 * n.z, 0.9 * n.x);
    pairs.emplace_back(irradianceWithNearField(*result.transported, scene.options.lookup, at, n).rgb,
                       irradianceOfSlope(n));
  }
  EXPECT_LT(errorOf(pairs), 0.02);
}

// A wall of 2 m that goes on to both sides hides half of what is below its upper edge. Broken by: no shadows (.26).
TEST_F(DistantLightsTest, AWallHidesItsPartOfTheSky) {
  constexpr double kHigh = 2.0;
  Scene scene = openScene();
  addFloor(scene);
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform = {{-kFloor, 0.0, 0.5 * kHigh}, rotationFromEulerDegrees({0.0, 90.0, 0.0}), {kHigh, 2000.0, 1.0}};
  for (const bool reduced : {false, true}) {
    std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs;
    for (const auto& seen : floorOf(scene, reduced)) {
      const double away = seen.at.x + kFloor;
      pairs.emplace_back(seen.e, glm::dvec3(0.5 * kPi * (1.0 + away / std::hypot(away, kHigh))));
    }
    EXPECT_LT(errorOf(pairs), reduced ? 0.03 : 0.02) << reduced;
  }
}

/// A square of 1 m, stretched, turned by angles in degrees and moved.
void addWall(Scene& scene, const std::string& name, const glm::dvec3& at, const glm::dvec3& degrees, double wide,
             double high) {
  test::addSurface(scene, name, reference::quad()).transform = {
      at, rotationFromEulerDegrees(degrees), {wide, high, 1.0}};
}

// The floor of a room of 3.8 x 3.8 x 2.4 m gets from a window of .8 m what a pane that glows would send: streams, which
// look in the same 256 directions from everywhere, on the whole. Broken by: darkness that is believed after eight rays
// (4 % too little), or four (22 % in streams); cells that look as often as at lamps (20 % too little in the volume).
TEST_F(DistantLightsTest, AWindowIsALight) {
  constexpr double kWall = 1.9, kHigh = 2.4, kSill = 0.6, kTop = 1.4, kWindow = 0.4;
  const glm::dvec3 facingX(90.0, 90.0, 0.0), facingY(90.0, 0.0, 0.0);
  Scene scene = openScene();
  addFloor(scene).transform.scale = glm::dvec3(2.0 * kWall);
  addWall(scene, "ceiling", {0.0, 0.0, kHigh}, {}, 2.0 * kWall, 2.0 * kWall);
  addWall(scene, "right", {kWall, 0.0, 0.5 * kHigh}, facingX, 2.0 * kWall, kHigh);
  addWall(scene, "front", {0.0, -kWall, 0.5 * kHigh}, facingY, 2.0 * kWall, kHigh);
  addWall(scene, "back", {0.0, kWall, 0.5 * kHigh}, facingY, 2.0 * kWall, kHigh);
  addWall(scene, "below", {-kWall, 0.0, 0.5 * kSill}, facingX, 2.0 * kWall, kSill);
  addWall(scene, "above", {-kWall, 0.0, 0.5 * (kTop + kHigh)}, facingX, 2.0 * kWall, kHigh - kTop);
  for (const double side : {-1.0, 1.0}) {
    addWall(scene, side < 0.0 ? "before" : "behind", {-kWall, side * 0.5 * (kWall + kWindow), 0.5 * (kSill + kTop)},
            facingX, kWall - kWindow, kTop - kSill);
  }
  const glm::dvec3 corners[4] = {
      {-kWall, -kWindow, kSill}, {-kWall, kWindow, kSill}, {-kWall, kWindow, kTop}, {-kWall, -kWindow, kTop}};
  for (const bool reduced : {false, true}) {
    std::vector<std::pair<glm::dvec3, glm::dvec3>> pairs;
    double got = 0.0, want = 0.0;
    for (const auto& seen : floorOf(scene, reduced)) {
      const auto to = [&](int i) { return corners[i] - seen.at; };
      const double e =
          triangleIrradiance({to(0), to(1), to(2)}, kUp, 2) + triangleIrradiance({to(0), to(2), to(3)}, kUp, 2);
      pairs.emplace_back(seen.e, glm::dvec3(e));
      got += seen.e.x;
      want += e;
    }
    EXPECT_LT(errorOf(pairs), reduced ? 0.4 : 0.15) << reduced;
    EXPECT_NEAR(got, want, 0.03 * want) << reduced;
  }
  TickRequest request = test::requestOf(scene, 2);
  request.transported = true;
  const TickResult result = run(request);
  ASSERT_NE(result.transported, nullptr);
  double got = 0.0, want = 0.0;
  for (int i = 0; i < 100; ++i) {
    const glm::dvec3 at(-0.6 + 0.02 * i, -1.2 + 0.24 * (i % 10), 0.3 + 0.1 * (i % 7));
    const auto to = [&](int k) { return corners[k] - at; };
    const glm::dvec3 n(-1.0, 0.0, 0.0);
    got += irradianceAt(*result.transported, scene.options.lookup, at, n).rgb.x;
    want += triangleIrradiance({to(0), to(1), to(2)}, n, 2) + triangleIrradiance({to(0), to(2), to(3)}, n, 2);
  }
  EXPECT_NEAR(got, want, 0.1 * want) << "in the volume";
}

// Broken by: rays that end within the grid.
TEST_F(DistantLightsTest, AClosedBoxIsDark) {
  Scene scene = openScene();
  addFloor(scene);
  test::addSurface(scene, "box", reference::box(glm::dvec3(-1.95), glm::dvec3(1.95, 1.95, 2.5)));
  for (const auto& seen : floorOf(scene)) ASSERT_LT(seen.e.x, 1e-3 * kPi);
}

// What is behind everything is seen where nothing else is, in its direction, from wherever. Broken by: a far plane that
// cuts it off; a sphere about the grid's middle.
TEST_F(DistantLightsTest, CamerasSeeTheSkyBehindEverything) {
  Scene scene = openScene(slopePicture());
  addFloor(scene);
  for (const glm::dvec3& eye : {glm::dvec3(0.0, 0.0, 1.0), glm::dvec3(500.0, -300.0, 40.0)}) {
    Camera camera;
    camera.eye = eye;
    camera.target = eye + glm::dvec3(0.3, 1.0, 0.2);
    camera.up = kUp;
    camera.fovDegrees = 60.0;
    camera.far = 50.0;
    TickRequest request = test::requestOf(scene);
    request.frames = {test::linearFrame(camera)};
    const TickResult result = run(request);
    ASSERT_EQ(result.frames.size(), 1U);
    for (const int x : {3, 32, 60}) {
      const glm::dvec3 ray = camera.rayDirection((x + 0.5) / 64.0, 10.5 / 64.0, 1.0);
      const glm::dvec3 got = test::pixel(*result.frames[0], x, 10), want = slope(glm::normalize(ray));
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], 0.01) << x << " " << c << " from " << eye.x;
    }
  }
}

}  // namespace
}  // namespace lpv
