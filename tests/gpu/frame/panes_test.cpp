// Panes and masks in frames: what comes through to what is lit, and what is seen through them.

#include <cmath>

#include "gpu/engine/engine_rig.h"
#include "reference/textures.h"
#include "scene/lookup.h"

namespace lpv {
namespace {

using test::pixel;

class PanesTest : public test::EngineTest {
 protected:
  FramePtr frame(const Scene& scene, const FrameRequest& request, SessionKey session = 1) {
    TickRequest tick = test::requestOf(scene, session);
    tick.frames = {request};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
  glm::dvec3 mean(const Scene& scene, const glm::ivec2& size = {64, 64}) {
    const FramePtr picture = frame(scene, test::linearFrame(test::frontCamera(), size));
    glm::dvec3 sum(0.0);
    for (int y = 0; y < size.y; ++y) {
      for (int x = 0; x < size.x; ++x) sum += pixel(*picture, x, y) / double(size.x * size.y);
    }
    return sum;
  }
};

/// A wall of 6 m in z = 0, that a lamp of .8 m behind the camera lights, which is not seen.
Scene litWall() {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.transport = Transport::kDirect;
  scene.options.bounces = 0;
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform = {{0, 0, 3}, glm::angleAxis(std::acos(-1.0), glm::dvec3(0, 1, 0)), glm::dvec3(0.8)};
  light.visibleToCamera = false;
  test::addSurface(scene, "wall", reference::quad()).transform.scale = glm::dvec3(6.0);
  return scene;
}

/// A square of 12 m at height z, between wall and lamp.
Surface& addPane(Scene& scene, double z, const glm::dvec3& transmission, double opacity) {
  Surface& pane = test::addSurface(scene, "pane", reference::quadOf(1));
  pane.transform = {{0, 0, z}, {1, 0, 0, 0}, glm::dvec3(12.0)};
  pane.alphaMode = AlphaMode::kBlend;
  pane.transmission = transmission;
  pane.opacity = opacity;
  pane.albedo = glm::dvec3(0.0);
  return pane;
}

void expectShare(const glm::dvec3& got, const glm::dvec3& of, const glm::dvec3& share, double within) {
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(got[c] / of[c], share[c], within) << c;
}

// Red where the pane counts twice, where its colour is left out, or where a frame follows bits of rays.
TEST_F(PanesTest, ARedPaneLetsHalfOfTheRedThrough) {
  Scene scene = litWall();
  const glm::dvec3 open = mean(scene);
  addPane(scene, 2.5, {1.0, 0.0, 0.0}, 0.5);  // behind the camera
  for (const bool reduced : {false, true}) {
    FrameRequest request = test::linearFrame(test::frontCamera());
    request.reduced = reduced;
    const FramePtr picture = frame(scene, request, reduced ? 2 : 1);
    glm::dvec3 sum(0.0);
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) sum += pixel(*picture, x, y) / (64.0 * 64.0);
    }
    expectShare(sum, open, {0.5, 0.0, 0.0}, reduced ? 0.01 : 1e-3);
  }
}

TEST_F(PanesTest, ABoxOfGlassTakesItsShareTwice) {
  Scene scene = litWall();
  const glm::dvec3 open = mean(scene);
  addPane(scene, 0.0, {1.0, 1.0, 0.5}, 0.5).mesh = reference::box({-0.5, -0.5, 0.2}, {0.5, 0.5, 0.21});
  scene.surfaces["pane"] = [&] {
    auto box = std::make_shared<Surface>(*scene.surfaces["pane"]);
    box->visibleToCamera = false;
    return box;
  }();
  expectShare(mean(scene), open, {0.25, 0.25, 0.0625}, 1e-3);
}

// A grille of bars that cover one half, near the lamp: the wall gets the other half. Red where a mask is opaque, or is
// the mean of each triangle; the tolerance is what rays by the hundred leave.
TEST_F(PanesTest, AGrillesShadowHasItsOpenFraction) {
  Scene scene = litWall();
  const glm::dvec3 open = mean(scene);
  Surface& grille = addPane(scene, 2.5, glm::dvec3(1.0), 1.0);
  grille.alphaMode = AlphaMode::kMask;
  grille.albedoTexture =
      reference::alphaTextureOf(256, 4, [](int x, int) { return std::uint8_t(x % 4 == 1 ? 0 : 255); });
  expectShare(mean(scene), open, glm::dvec3(0.25), 0.02);
}

TEST_F(PanesTest, WhatLiesBehindIsSeenThroughThem) {
  Scene scene = litWall();
  scene.options.visibility = Visibility::kOff;
  const glm::dvec3 open = mean(scene);
  Surface& pane = addPane(scene, 1.0, {1.0, 0.5, 0.25}, 0.2);
  expectShare(mean(scene), open, {0.8, 0.4, 0.2}, 2e-3);
  pane.opacity = 0.6;  // now it is drawn, in black
  scene.surfaces["pane"] = std::make_shared<Surface>(pane);
  EXPECT_EQ(mean(scene), glm::dvec3(0.0));
  pane.opacity = 0.2;
  pane.transform.translation.z = -1.0;  // behind the wall
  scene.surfaces["pane"] = std::make_shared<Surface>(pane);
  EXPECT_EQ(mean(scene), open);
  pane.transform.translation.z = 1.0;
  pane.visibleToCamera = false;
  scene.surfaces["pane"] = std::make_shared<Surface>(pane);
  EXPECT_EQ(mean(scene), open);
}

// Of 8 bits, with an exposure that is known and with one that is found.
TEST_F(PanesTest, TheyAreExposedWithThePicture) {
  Scene scene = litWall();
  scene.options.visibility = Visibility::kOff;
  Scene dark = scene;
  addPane(scene, 1.0, glm::dvec3(1.0), 0.25);
  FrameRequest request = test::linearFrame(test::frontCamera());
  request.format = PixelFormat::kRgb8;
  request.exposure.automatic = false;
  request.exposure.ev = 1.0;
  Light& lamp = test::lightOf(dark);
  lamp.radiance *= 0.75;
  const FramePtr through = frame(scene, request), direct = frame(dark, request, 2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(pixel(*through, 20, 30)[c], pixel(*direct, 20, 30)[c], 1.0);
  request.exposure.automatic = true;
  EXPECT_NEAR(frame(scene, request)->exposureEv, frame(dark, request, 2)->exposureEv, 0.01);
}

// Red with the whole card drawn, or nothing of it.
TEST_F(PanesTest, AMaskIsDrawnByTexel) {
  Scene scene = litWall();
  scene.options.visibility = Visibility::kOff;
  const FramePtr open = frame(scene, test::linearFrame(test::frontCamera()));
  Surface& card = addPane(scene, 1.0, glm::dvec3(1.0), 1.0);
  card.transform.scale = glm::dvec3(1.0);
  card.alphaMode = AlphaMode::kMask;
  card.albedoTexture = reference::alphaTextureOf(2, 2, [](int x, int y) { return std::uint8_t(x == y ? 255 : 0); });
  const FramePtr picture = frame(scene, test::linearFrame(test::frontCamera()));
  for (const int x : {23, 40}) {
    for (const int y : {23, 40}) {
      const bool covered = (x < 32) == (y < 32);
      EXPECT_EQ(pixel(*picture, x, y), covered ? glm::dvec3(0.0) : pixel(*open, x, y)) << x << " " << y;
    }
  }
}

// Red where cells take a pane for a wall, or see through it.
TEST_F(PanesTest, CellsHaveTheMeanOfThreeColours) {
  Scene scene = litWall();
  scene.options.transport = Transport::kGather;
  test::lightOf(scene).transform.translation.z = 1.8;
  scene.surfaces["wall"] = [&] {  // at the far end of the grid
    auto wall = std::make_shared<Surface>(*scene.surfaces["wall"]);
    wall->transform.translation.z = -2.0;
    return wall;
  }();
  const auto volumeOf = [&](SessionKey session) {
    TickRequest request = test::requestOf(scene, session);
    request.transported = request.probed = true;
    return run(request).transported;
  };
  const VolumePtr open = volumeOf(1);
  addPane(scene, 1.0, {1.0, 0.5, 0.0}, 0.2);
  const VolumePtr through = volumeOf(2);
  ASSERT_TRUE(open != nullptr && through != nullptr);
  const glm::dvec3 n(0.0, 0.0, 1.0);
  for (const double x : {-1.0, 0.1, 0.8}) {
    const glm::dvec3 behind(x, 0.3, -0.5), before(x, 0.3, 1.4);
    expectShare(irradianceAt(*through, Lookup::kCap, behind, n).rgb, irradianceAt(*open, Lookup::kCap, behind, n).rgb,
                glm::dvec3(0.4), 1e-3);
    EXPECT_EQ(irradianceAt(*through, Lookup::kCap, before, n).rgb, irradianceAt(*open, Lookup::kCap, before, n).rgb);
  }
}

// A room in two halves that a pane of glass parts: what the lit half reflects comes through. Red where pairs of patches
// are open or not.
TEST_F(PanesTest, WhatSurfacesReflectComesThrough) {
  Scene scene = litWall();
  scene.options.bounces = 3;
  scene.surfaces.erase("wall");
  test::addSurface(scene, "room", reference::box({-2, -2, -2}, {2, 2, 2}, true));
  test::lightOf(scene).transform = {{0, 0, -1}, glm::angleAxis(std::acos(-1.0), glm::dvec3(0, 1, 0)), glm::dvec3(0.5)};
  const FrameRequest request = [] {  // the wall in front of the pane, which no lamp shines at
    FrameRequest out = test::linearFrame(test::frontCamera(), {32, 32});
    out.camera.eye = {0, 0, 0.5};
    out.camera.target = {0, 0, 2};
    return out;
  }();
  const auto middle = [&](SessionKey session) { return pixel(*frame(scene, request, session), 16, 16); };
  Surface& pane = addPane(scene, 0.25, {1.0, 0.0, 0.0}, 0.0);
  pane.transform.scale = glm::dvec3(4.0);
  const glm::dvec3 red = middle(1);
  pane.opacity = 0.5;
  scene.surfaces["pane"] = std::make_shared<Surface>(pane);
  const glm::dvec3 half = middle(2);
  EXPECT_GT(red.x, 1e-3);
  EXPECT_LT(red.y, 1e-6);
  EXPECT_GT(half.x / red.x, 0.3);
  EXPECT_LT(half.x / red.x, 0.55);
}

}  // namespace
}  // namespace lpv
