// Frames: which way is up, what is in front, which side shines, how bright.

#include <algorithm>
#include <cmath>

#include "gpu/engine/engine_rig.h"
#include "reference/textures.h"
#include "scene/lookup.h"
#include "scene/tonemap.h"

namespace lpv {
namespace {

using test::pixel;

class FrameTest : public test::EngineTest {
 protected:
  /// A dark scene with one square light of 1 x 1 m in z = 0 at `at`.
  static Scene sceneWithSquare(const glm::dvec3& at) {
    Scene scene = test::smallScene();
    Light& light = test::lightOf(scene);
    light.mesh = reference::quad();
    light.transform.translation = at;
    return scene;
  }
  FramePtr frame(const Scene& scene, const FrameRequest& request, SessionKey session = 1) {
    TickRequest tick = test::requestOf(scene, session);
    tick.frames = {request};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
};

const glm::dvec3 kRadiance(4.0, 2.0, 1.0);

// Broken by: GL_LOWER_LEFT in glClipControl; a right vector with the wrong sign.
TEST_F(FrameTest, RowsRunFromTopAndColumnsFromLeft) {
  const FramePtr picture = frame(sceneWithSquare({-1.0, 1.0, 0.0}), test::linearFrame(test::frontCamera()));
  EXPECT_EQ(pixel(*picture, 16, 16), kRadiance) << "up and left";
  EXPECT_EQ(pixel(*picture, 48, 16), glm::dvec3(0.0)) << "up and right";
  EXPECT_EQ(pixel(*picture, 16, 48), glm::dvec3(0.0)) << "down and left";
}

// Exactly the pixels whose centres are inside: 1 m of 4 m over 64 pixels.
TEST_F(FrameTest, SizeAndAspect) {
  const FramePtr picture = frame(sceneWithSquare(glm::dvec3(0.0)), test::linearFrame(test::frontCamera(), {128, 64}));
  int lit = 0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 128; ++x) lit += pixel(*picture, x, y).x > 0.0 ? 1 : 0;
  }
  EXPECT_EQ(lit, 16 * 16);
}

// Broken by: GL_LESS with reversed depth; comparing depths the other way round in shade.frag.
TEST_F(FrameTest, TheNearerOfLightAndSurfaceIsSeen) {
  for (const double z : {-0.5, 0.5}) {
    Scene scene = sceneWithSquare({0.0, 0.0, z});
    test::addSurface(scene, "wall", reference::quad()).transform.scale = glm::dvec3(3.0);
    const FramePtr picture = frame(scene, test::linearFrame(test::frontCamera()));
    EXPECT_EQ(pixel(*picture, 32, 32) == kRadiance, z > 0.0) << z;
  }
}

TEST_F(FrameTest, TheNearerOfTwoLightsIsSeen) {
  for (const double z : {-0.5, 0.5}) {
    Scene scene = sceneWithSquare({0.0, 0.0, z});
    auto red = std::make_shared<Light>(*scene.lights.at("light"));
    red->transform.translation.z = 0.0;
    red->radiance = {9.0, 0.0, 0.0};
    scene.lights["a red one"] = red;
    EXPECT_EQ(pixel(*frame(scene, test::linearFrame(test::frontCamera())), 32, 32) == kRadiance, z > 0.0) << z;
  }
}

// Broken by: not turning glFrontFace for mirrors; showing both sides.
TEST_F(FrameTest, OnlyTheEmittingSideShines) {
  for (const bool mirrored : {false, true}) {
    for (const bool twoSided : {false, true}) {
      for (const double side : {2.0, -2.0}) {
        Scene scene = sceneWithSquare(glm::dvec3(0.0));
        Light& light = test::lightOf(scene);
        if (mirrored) light.transform.scale.x = -1.0;
        light.twoSided = twoSided;
        const FramePtr picture = frame(scene, test::linearFrame(test::frontCamera(side)));
        EXPECT_EQ(pixel(*picture, 32, 32) == kRadiance, twoSided || side > 0.0) << mirrored << twoSided << side;
      }
    }
  }
}

// A light's dark back hides what is behind it.
TEST_F(FrameTest, TheBackOfALightIsOpaque) {
  Scene scene = sceneWithSquare(glm::dvec3(0.0));
  auto behind = std::make_shared<Light>(*scene.lights.at("light"));
  behind->transform.translation.z = 0.5;  // seen from -z: behind the first
  behind->twoSided = true;
  scene.lights["behind"] = behind;
  EXPECT_EQ(pixel(*frame(scene, test::linearFrame(test::frontCamera(-2.0))), 32, 32), glm::dvec3(0.0));
}

// Red where the G-buffer or the pass of the lights draws them.
TEST_F(FrameTest, WhatCamerasDoNotSeeIsNotDrawnAndLights) {
  Scene scene = sceneWithSquare({0.0, 0.0, 0.5});
  scene.options.transport = Transport::kDirect;
  test::addSurface(scene, "wall", reference::quad()).transform = {{0, 0, -0.5}, {1, 0, 0, 0}, glm::dvec3(3)};
  Surface& screen = test::addSurface(scene, "screen", reference::quad());
  screen.transform = {{0, 0, 0.75}, {1, 0, 0, 0}, glm::dvec3(3)};
  screen.twoSided = false;
  Light& light = test::lightOf(scene);
  light.twoSided = true;
  const auto middle = [&] { return pixel(*frame(scene, test::linearFrame(test::frontCamera())), 32, 32); };
  EXPECT_EQ(middle(), glm::dvec3(0.0)) << "the screen's dark front";
  screen.visibleToCamera = false;
  scene.surfaces["screen"] = std::make_shared<Surface>(screen);
  EXPECT_EQ(middle(), kRadiance);
  light.visibleToCamera = false;
  scene.lights["light"] = std::make_shared<Light>(light);
  const glm::dvec3 wall = middle();
  EXPECT_GT(wall.x, 0.05);
  EXPECT_LT(wall.x, 0.5 * kRadiance.x);
}

TEST_F(FrameTest, OneSidedSurfacesAreNotSeenFromBehind) {
  Scene scene = sceneWithSquare({0.0, 0.0, 0.0});
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(3.0);
  wall.transform.rotation = glm::angleAxis(std::acos(-1.0), glm::dvec3(0, 1, 0));
  wall.transform.translation.z = 0.5;
  wall.twoSided = false;
  EXPECT_EQ(pixel(*frame(scene, test::linearFrame(test::frontCamera())), 32, 32), kRadiance);
  wall.transform.rotation = glm::dquat(1, 0, 0, 0);
  EXPECT_NE(pixel(*frame(scene, test::linearFrame(test::frontCamera()), 2), 32, 32), kRadiance);
}

// A pixel is albedo E / pi at its own point and normal, E as Probe says.
// Broken by: rays not through pixel centres; a normal not towards the viewer; pi left out.
TEST_F(FrameTest, PixelsAreWhatIrradianceAtSays) {
  for (const bool behind : {false, true}) {
    Scene scene = test::smallScene();
    test::lightOf(scene).transform.scale = glm::dvec3(0.4);
    Surface& wall = test::addSurface(scene, "wall", reference::quad());
    wall.transform.scale = glm::dvec3(3.0);
    wall.transform.translation.z = -0.9;
    wall.albedo = {0.9, 0.5, 0.1};
    Camera camera = test::frontCamera(behind ? -1.9 : 1.0);
    TickRequest request = test::requestOf(scene);
    request.transported = true;
    request.frames = {test::linearFrame(camera)};
    const TickResult result = run(request);
    int compared = 0;
    for (int y = 0; y < 64; y += 3) {
      for (int x = 0; x < 64; x += 3) {
        const glm::dvec3 ray = camera.rayDirection((x + 0.5) / 64.0, (y + 0.5) / 64.0, 1.0);
        const glm::dvec3 p = camera.eye + ray * ((-0.9 - camera.eye.z) / ray.z);
        const bool hidden = !behind && glm::length(glm::dvec2(camera.eye + ray * (-camera.eye.z / ray.z))) < 0.4;
        if (hidden || std::abs(p.x) > 1.45 || std::abs(p.y) > 1.45) continue;
        const glm::dvec3 n(0.0, 0.0, behind ? -1.0 : 1.0);
        const glm::dvec3 want =
            wall.albedo * irradianceAt(*result.transported, Lookup::kSh2, p, n).rgb / std::acos(-1.0);
        const glm::dvec3 got = pixel(*result.frames[0], x, y);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c], want[c], 1e-3 * want[c] + 1e-7) << x << " " << y;
        ++compared;
      }
    }
    EXPECT_GT(compared, 50);
  }
}

TEST_F(FrameTest, FixedExposureIsAppliedBeforeTheCurve) {
  FrameRequest request = test::linearFrame(test::frontCamera());
  request.format = PixelFormat::kRgb8;
  request.exposure = {false, -2.0};
  const FramePtr picture = frame(sceneWithSquare(glm::dvec3(0.0)), request);
  const glm::u8vec3 want = displayFromRadiance(kRadiance, -2.0);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(*picture, 32, 32)[c], want[c], 1.0);
  EXPECT_EQ(picture->exposureEv, -2.0);
  EXPECT_EQ(pixel(*picture, 1, 1), glm::dvec3(0.0));
}

// Automatic: the mean lightness of the pixels that show a surface comes to the key's, and stops are added to it.
// Broken by: averaging over the background or the emitters too; natural logarithms; averaging luminance itself.
TEST_F(FrameTest, AutomaticExposureBringsSurfacesToTheKey) {
  Scene scene = test::smallScene();
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(2.0);
  wall.transform.translation.z = -0.9;
  TickRequest request = test::requestOf(scene);
  FrameRequest linear = test::linearFrame(test::frontCamera(), {80, 48});
  FrameRequest automatic = linear;
  automatic.format = PixelFormat::kRgb8;
  automatic.exposure = {true, 1.0};
  request.frames = {linear, automatic};
  const TickResult result = run(request);
  double sum = 0.0, count = 0.0;
  for (int y = 0; y < 48; ++y) {
    for (int x = 0; x < 80; ++x) {
      const glm::dvec3 c = pixel(*result.frames[0], x, y);
      if (c == glm::dvec3(0.0) || c == kRadiance) continue;
      sum += std::cbrt(glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722)));
      count += 1.0;
    }
  }
  const double want = std::log2(kAutoExposureKey) - 3.0 * std::log2(sum / count) + 1.0;
  EXPECT_NEAR(result.frames[1]->exposureEv, want, 1e-3);
  const glm::u8vec3 display = displayFromRadiance(pixel(*result.frames[0], 40, 44), want);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(*result.frames[1], 40, 44)[c], display[c], 1.0);
}

TEST_F(FrameTest, NothingToSeeHasAnExposureToo) {
  Scene scene = test::smallScene();
  test::lightOf(scene).enabled = false;
  FrameRequest request = test::linearFrame(test::frontCamera());
  request.format = PixelFormat::kRgb8;
  EXPECT_TRUE(std::isfinite(frame(scene, request)->exposureEv));
}

// Albedo textures: the first row is v = 0, sRGB is decoded, repeat. The lookup elsewhere in this file is exact, so
// ratios between pixels under the same light are those of the texels (to 1/32: the pixels are that far from texel
// centres).
TEST_F(FrameTest, AlbedoTexturesAreSeenUpright) {
  auto texture = std::make_shared<Texture>();
  texture->width = texture->height = 2;
  texture->texels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188};  // red, green; blue, grey of .503
  Scene scene = test::smallScene();
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(2.0);
  wall.transform.translation.z = -0.9;
  wall.albedo = glm::dvec3(1.0);
  test::lightOf(scene).transform.translation.z = 1.5;  // behind the camera
  test::lightOf(scene).radiance = glm::dvec3(5.0);
  const FrameRequest request = test::linearFrame(test::frontCamera(0.1));
  const FramePtr plain = frame(scene, request);
  wall.albedoTexture = texture;
  wall.name = "textured";
  const FramePtr picture = frame(scene, request, 2);
  const auto ratio = [&](int x, int y) { return pixel(*picture, x, y) / pixel(*plain, x, y); };
  const std::vector<std::pair<glm::ivec2, glm::dvec3>> want = {{{16, 16}, {1, 0, 0}},
                                                               {{47, 16}, {0, 1, 0}},
                                                               {{16, 47}, {0, 0, 1}},
                                                               {{47, 47}, glm::dvec3(linearFromSrgb(188 / 255.0))}};
  for (const auto& [at, colour] : want) {
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(ratio(at.x, at.y)[c], colour[c], 0.05) << at.x << " " << at.y;
  }
}

// Stripes that run away from the viewer over a floor seen at five degrees: a pixel is a texel wide and thirty long.
// Broken by: the mip level of a pixel's length (.0).
TEST_F(FrameTest, StripesStaySharpWhereTheyAreSeenAskew) {
  Scene scene = test::smallScene();
  Surface& floor = test::addSurface(scene, "floor", reference::quad());
  floor.transform.scale = glm::dvec3(2.0);
  floor.transform.translation.z = -0.9;
  floor.albedo = glm::dvec3(1.0);
  test::lightOf(scene).transform.rotation = rotationFromEulerDegrees({180.0, 0.0, 0.0});
  test::lightOf(scene).transform.translation.z = 0.9;
  FrameRequest request = test::linearFrame(test::frontCamera(), {128, 64});
  request.camera = {.eye = {0.0, -1.2, -0.72}, .target = {0.0, 0.6, -0.9}, .up = {0.0, 0.0, 1.0}, .fovDegrees = 50.0};
  const FramePtr plain = frame(scene, request);
  floor.name = "striped";
  floor.albedoTexture = reference::textureOf(32, 32, [](int x, int) { return glm::dvec3(x % 2); });
  const FramePtr picture = frame(scene, request, 2);
  double darkest = 1.0, brightest = 0.0;
  for (int x = 40; x < 88; ++x) {
    const double share = pixel(*picture, x, 32).x / pixel(*plain, x, 32).x;
    darkest = std::min(darkest, share);
    brightest = std::max(brightest, share);
  }
  EXPECT_GE(brightest - darkest, 0.5);
}

TEST_F(FrameTest, SeveralFramesOfOneTickAreEachTheirOwn) {
  const Scene scene = sceneWithSquare(glm::dvec3(0.0));
  TickRequest request = test::requestOf(scene);
  request.frames = {test::linearFrame(test::frontCamera()), test::linearFrame(test::frontCamera(-2.0)),
                    test::linearFrame(test::frontCamera(), {32, 16})};
  for (FrameRequest& f : request.frames) f.view = 3;  // even if one view is named thrice
  const TickResult result = run(request);
  ASSERT_EQ(result.frames.size(), 3U);
  EXPECT_EQ(pixel(*result.frames[0], 32, 32), kRadiance);
  EXPECT_EQ(pixel(*result.frames[1], 32, 32), glm::dvec3(0.0));
  EXPECT_EQ(pixel(*result.frames[2], 16, 8), kRadiance);
}

}  // namespace
}  // namespace lpv
