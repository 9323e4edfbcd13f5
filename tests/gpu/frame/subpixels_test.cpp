// Several samples of each pixel: what edges and textures become, and that light stays what it is.

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "gpu/engine/engine_rig.h"
#include "gpu/frame/light_views.h"
#include "reference/textures.h"

namespace lpv {
namespace {

using test::pixel;

class SubpixelsTest : public test::EngineTest {
 protected:
  FramePtr frame(const Scene& scene, const FrameRequest& request, SessionKey session = 1) {
    TickRequest tick = test::requestOf(scene, session);
    tick.frames = {request};
    const TickResult result = run(tick);
    return result.frames.size() == 1 ? result.frames[0] : std::make_shared<Frame>();
  }
};

constexpr double kPixel = 4.0 / 64.0;  // metres, of test::frontCamera in z = 0

/// A square of 1 m that shines towards the camera, so many pixels right of where its edges lie between pixels.
Scene squareAt(double pixels) {
  Scene scene = test::smallScene();
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform.translation = {pixels * kPixel, 0.0, 0.0};
  return scene;
}

FrameRequest sampled(int samples, const glm::ivec2& size = {64, 64}) {
  FrameRequest request = test::linearFrame(test::frontCamera(), size);
  request.samples = samples;
  return request;
}

// Columns 24 to 39 are the square's; moved by part of a pixel, the edges' pixels have that part of it.
// Broken by: an offset with the wrong sign; samples that are weighed by a count other than theirs.
TEST_F(SubpixelsTest, AnEdgeIsAShare) {
  const double radiance = 4.0;
  for (const int samples : {2, 4, 8, 16, 32, 64}) {
    for (const double moved : {0.5, 0.25, 0.75}) {
      const FramePtr picture = frame(squareAt(moved + 1e-3), sampled(samples));
      const double within = samples == 2 ? 0.26 : 0.51 / samples;
      EXPECT_NEAR(pixel(*picture, 24, 32).x, radiance * (1.0 - moved), radiance * within) << samples << ", " << moved;
      EXPECT_NEAR(pixel(*picture, 40, 32).x, radiance * moved, radiance * within) << samples << ", " << moved;
      EXPECT_EQ(pixel(*picture, 32, 32).x, radiance) << samples;
      EXPECT_EQ(pixel(*picture, 20, 32).x, 0.0) << samples;
    }
  }
}

// The same up and down, on all four sides at once: the square's light is its area's, wherever it lies.
// Broken by: rows that are moved the other way than columns.
TEST_F(SubpixelsTest, AMovedSquareShinesAsMuch) {
  Scene scene = squareAt(0.37);
  test::lightOf(scene).transform.translation.y = 0.23 * kPixel;
  const FramePtr picture = frame(scene, sampled(8));
  double sum = 0.0;
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) sum += pixel(*picture, x, y).x;
  }
  EXPECT_NEAR(sum, 4.0 * 16 * 16, 0.01 * 4.0 * 16 * 16);
}

/// How much of a pixel a square of 1 m shows that is turned by `turned`, of test::frontCamera.
double shareOfTurned(int x, int y, double turned) {
  constexpr int kParts = 64;
  int inside = 0;
  for (int i = 0; i < kParts * kParts; ++i) {
    const glm::dvec2 at =
        kPixel * (glm::dvec2(x, 63 - y) + (glm::dvec2(i % kParts, i / kParts) + 0.5) / double(kParts)) - 2.0;  // y up
    const glm::dvec2 own(std::cos(turned) * at.x + std::sin(turned) * at.y,
                         std::cos(turned) * at.y - std::sin(turned) * at.x);
    inside += int(std::max(std::abs(own.x), std::abs(own.y)) < 0.5);
  }
  return double(inside) / (kParts * kParts);
}

// A light's edge is brighter than what is beside it: it is looked for in the samples' mirror images, too.
// Broken by: the samples of surfaces alone (.06).
TEST_F(SubpixelsTest, ALightsEdgeIsKnownBetter) {
  const double turned = 0.3;
  Scene scene = squareAt(0.0);
  scene.options = {};
  scene.options.visibility = Visibility::kOn;
  scene.options.bounces = 0;
  test::lightOf(scene).transform.rotation = glm::angleAxis(turned, glm::dvec3(0.0, 0.0, 1.0));
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(8.0);
  wall.transform.translation.z = -1.0;
  wall.albedo = glm::dvec3(0.0);
  const FramePtr picture = frame(scene, sampled(8));
  double squares = 0.0;
  int partly = 0;
  for (int i = 0; i < 64 * 64; ++i) {
    const double share = shareOfTurned(i % 64, i / 64, turned);
    if (share == 0.0 || share == 1.0) continue;
    const double off = pixel(*picture, i % 64, i / 64).x / 4.0 - share;
    squares += off * off;
    ++partly;
  }
  ASSERT_GT(partly, 40);
  EXPECT_LT(std::sqrt(squares / partly), 0.05);
}

/// A white wall whose right half is darker, lit evenly enough, the border in the middle of column 32.
Scene halvedWall(double albedo) {
  Scene scene = test::smallScene();
  scene.options = {};
  scene.options.transport = Transport::kDirect;
  scene.options.visibility = Visibility::kOff;
  scene.options.bounces = 0;
  Light& light = test::lightOf(scene);
  light.mesh = reference::quad();
  light.transform = {{0, 0, 3}, glm::angleAxis(std::acos(-1.0), glm::dvec3(0, 1, 0)), glm::dvec3(0.8)};
  light.visibleToCamera = false;
  for (const double side : {-1.0, 1.0}) {
    Surface& half = test::addSurface(scene, side < 0.0 ? "left" : "right", reference::quad());
    half.transform.scale = glm::dvec3(4.0);
    half.transform.translation = {0.5 * kPixel + 2.0 * side, 0.0, 0.0};
    half.albedo = glm::dvec3(side < 0.0 ? 1.0 : albedo);
  }
  return scene;
}

// Broken by: the albedo of the middle; a border lit as one of its sides is shaded.
TEST_F(SubpixelsTest, ABorderOnAWallIsTheMeanOfItsSides) {
  const FramePtr picture = frame(halvedWall(0.25), sampled(8)), plain = frame(halvedWall(1.0), sampled(1), 2);
  EXPECT_NEAR(pixel(*picture, 32, 20).x, 0.625 * pixel(*plain, 32, 20).x, 1e-3 * pixel(*plain, 32, 20).x);
  EXPECT_NEAR(pixel(*picture, 31, 20).x, pixel(*plain, 31, 20).x, 1e-3 * pixel(*plain, 31, 20).x);
  EXPECT_NEAR(pixel(*picture, 33, 20).x, 0.25 * pixel(*plain, 33, 20).x, 1e-3 * pixel(*plain, 33, 20).x);
}

// A light before the wall that is as bright as the wall is does not show; but where no sample of surfaces met the wall
// the one in twelve that may show it beside the light is dark.
// Broken by: more or less of the wall than the light leaves.
TEST_F(SubpixelsTest, SurfacesMakeRoomForALight) {
  Scene scene = halvedWall(1.0);
  const FramePtr wall = frame(scene, sampled(8));
  Scene squares = squareAt(0.0);
  Light square = test::lightOf(squares);
  square.name = "square";
  square.transform.rotation = glm::angleAxis(0.3, glm::dvec3(0.0, 0.0, 1.0));
  square.transform.translation.z = 0.01;
  square.radiance = glm::dvec3(pixel(*wall, 32, 32).x);
  scene.lights["square"] = std::make_shared<Light>(square);
  const FramePtr picture = frame(scene, sampled(8), 2);
  for (int y = 20; y < 44; ++y) {
    for (int x = 20; x < 44; ++x) {
      const auto [darker, brighter] = std::minmax(pixel(*wall, x, y).x, square.radiance.x);
      const bool isMet = shareOfTurned(x, y, 0.3) < 0.8;
      ASSERT_GT(pixel(*picture, x, y).x, (isMet ? 0.98 : 0.98 * 11.0 / 12.0) * darker) << x << ", " << y;
      ASSERT_LT(pixel(*picture, x, y).x, 1.02 * brighter) << x << ", " << y;
    }
  }
}

// A screen before the wall, its edge in the middle of a column: half of the pixel shows the wall, lit as the wall is
// beside it, half the screen, lit as that is.
// Broken by: all samples lit as the middle of their pixel.
TEST_F(SubpixelsTest, WhatIsBehindAnEdgeHasItsOwnLight) {
  Scene scene = halvedWall(1.0);
  Surface& screen = test::addSurface(scene, "screen", reference::quad());
  screen.transform.scale = glm::dvec3(2.0);
  screen.transform.translation = {0.25 * kPixel - 1.0, 0.0, 1.0};  // half a pixel of 2 m away
  const FramePtr picture = frame(scene, sampled(8));
  const double ofScreen = pixel(*picture, 31, 32).x, ofWall = pixel(*picture, 33, 32).x;
  ASSERT_GT(ofScreen, 1.5 * ofWall);
  EXPECT_NEAR(pixel(*picture, 32, 32).x, 0.5 * (ofScreen + ofWall), 0.02 * ofScreen);
}

/// A wall half a metre behind a strip of a fence, which columns `from` to `to` show, lit from before both, and from the
/// right by another wall.
Scene fence(double from, double to, int bounces) {
  Scene scene = halvedWall(1.0);
  scene.options.transport = Transport::kGather;
  scene.options.visibility = Visibility::kOn;
  scene.options.bounces = bounces;
  scene.surfaces.clear();
  test::lightOf(scene).transform.translation.z = 0.8;
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(6.0);
  wall.transform.translation.z = -0.5;
  wall.albedo = glm::dvec3(0.5);
  Surface& side = test::addSurface(scene, "side", reference::quad());
  side.transform = {{1.6, 0, 0}, glm::angleAxis(-0.5 * std::acos(-1.0), glm::dvec3(0, 1, 0)), glm::dvec3(4.0)};
  side.albedo = glm::dvec3(0.9);
  Surface& strip = test::addSurface(scene, "strip", reference::quad());
  strip.transform.scale = {(to - from) * kPixel, 4.0, 1.0};
  strip.transform.translation.x = (0.5 * (from + to) - 32.0) * kPixel;
  strip.albedo = glm::dvec3(0.9);
  return scene;
}

// What is thinner than a pixel, between the middles of all, is nearer to the light than what is around it.
// Broken by: samples that are lit as the pixel that is most like them, however unlike that is; light of another place;
// no light of surfaces.
TEST_F(SubpixelsTest, AStripThatNoMiddleShowsHasItsOwnLight) {
  const auto shown = [this](double from, double to, int bounces, int samples) {
    return frame(fence(from, to, bounces), sampled(samples));
  };
  const FramePtr lit = shown(40.6, 40.95, 0, 16), all = shown(40.6, 40.95, 2, 16);
  const FramePtr litWide = shown(38.0, 43.0, 0, 1), allWide = shown(38.0, 43.0, 2, 1);
  for (const int y : {20, 31, 45}) {
    const auto beside = [y](const Frame& f) { return 0.5 * (pixel(f, 38, y).x + pixel(f, 43, y).x); };
    const double strip = pixel(*litWide, 40, y).x, wall = beside(*lit);
    ASSERT_GT(strip, 2.0 * wall) << y;
    EXPECT_NEAR((pixel(*lit, 40, y).x - wall) / (strip - wall), 0.35, 0.06) << y;
    const double reflected = 0.35 * (pixel(*allWide, 40, y).x - strip) + 0.65 * (beside(*all) - wall);
    ASSERT_GT(reflected, 0.05 * wall) << y;
    EXPECT_NEAR(pixel(*all, 40, y).x - pixel(*lit, 40, y).x, reflected, 0.2 * reflected) << y;
  }
}

// The same with nothing in the lights' way, whether pixels read the volume or look at the lights.
// Broken by: places of their own only where there are shadows (.09 to .16 for .35).
TEST_F(SubpixelsTest, AStripThatNoMiddleShowsHasItsOwnLightWithoutShadows) {
  for (const Transport transport : {Transport::kGather, Transport::kDirect}) {
    const auto shown = [this, transport](double from, double to, int samples) {
      Scene scene = fence(from, to, 0);
      scene.options.transport = transport;
      scene.options.visibility = Visibility::kOff;
      return frame(scene, sampled(samples));
    };
    const FramePtr thin = shown(40.6, 40.95, 16), wide = shown(38.0, 43.0, 1);
    for (const int y : {20, 31, 45}) {
      const double strip = pixel(*wide, 40, y).x, wall = 0.5 * (pixel(*thin, 38, y).x + pixel(*thin, 43, y).x);
      ASSERT_GT(strip, 2.0 * wall) << y;
      EXPECT_NEAR((pixel(*thin, 40, y).x - wall) / (strip - wall), 0.35, 0.06) << int(transport) << ", " << y;
    }
  }
}

// Two strips in a pixel, one of them nearer to the light: each has light of its own, so that together they change the
// pixel by what each of them changes it. Broken by: one place for all of a pixel's samples (half of it).
TEST_F(SubpixelsTest, TwoStripsOfAPixelHaveTheirOwnLight) {
  const auto shown = [this](bool far, bool near, SessionKey session) {
    Scene scene = fence(40.1, 40.4, 0);
    Surface& second = test::addSurface(scene, "near strip", reference::quad());
    second.transform.scale = {0.3 * kPixel, 4.0, 1.0};
    second.transform.translation = {(40.75 - 32.0) * kPixel * (1.0 - 0.4 / 2.0), 0.0, 0.4};  // of 2 m away
    second.albedo = glm::dvec3(0.9);
    if (!far) scene.surfaces.erase("strip");
    if (!near) scene.surfaces.erase("near strip");
    return frame(scene, sampled(16), session);
  };
  const FramePtr none = shown(false, false, 1), both = shown(true, true, 2);
  const FramePtr onlyFar = shown(true, false, 3), onlyNear = shown(false, true, 4);
  for (const int y : {20, 31, 45}) {
    const auto at = [y, &none](const FramePtr& f) { return pixel(*f, 40, y).x - pixel(*none, 40, y).x; };
    ASSERT_GT(at(onlyNear), 1.5 * at(onlyFar)) << y;
    ASSERT_GT(at(onlyFar), 0.1 * pixel(*none, 40, y).x) << y;
    EXPECT_NEAR(at(both), at(onlyFar) + at(onlyNear), 0.05 * at(both)) << y;
  }
}

// A plate 5 cm before a wall, lit from the right: two fifths of column 40 show wall, in the plate's shadow, which ends
// before the middle of column 39. Broken by: samples that are lit as several alike around them are, if these are as
// bright as each other.
TEST_F(SubpixelsTest, BesideAPlateItsShadowIsDark) {
  Scene scene = fence(0.0, 1.0, 0);
  scene.surfaces.clear();
  const double edge = (40.4 - 32.0) * kPixel;
  Light& lamp = test::lightOf(scene);
  lamp.transform.translation = {edge + 1.5, 0.0, 2.05};
  lamp.transform.scale = glm::dvec3(0.05);
  Surface& wall = test::addSurface(scene, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(6.0);
  wall.albedo = glm::dvec3(0.5);
  Surface& plate = test::addSurface(scene, "plate", reference::quad());
  plate.transform.scale = {1.0, 4.0, 1.0};
  plate.transform.translation = {edge * (1.0 - 0.05 / 2.0) + 0.5, 0.0, 0.05};  // as seen from 2 m away
  plate.albedo = glm::dvec3(0.5);
  const FramePtr picture = frame(scene, sampled(32));
  for (const int y : {20, 31, 45}) {
    const double ofWall = pixel(*picture, 38, y).x, ofPlate = pixel(*picture, 41, y).x;
    ASSERT_GT(ofWall, 0.8 * ofPlate) << y;
    EXPECT_NEAR(pixel(*picture, 40, y).x, 0.6 * ofPlate, 0.06 * ofPlate) << y;
  }
}

/// Two slats before a wall in each of 64 columns, one nearer than the other.
Scene slats() {
  Scene scene = fence(40.1, 40.4, 0);
  scene.surfaces.erase("strip");
  for (const float z : {0.0F, 0.4F}) {
    const float column = float(kPixel) * (1.0F - 0.5F * z);  // of 2 m away
    const float from = z > 0.0F ? 0.125F : 0.5625F;  // 5 of 16 samples each
    Mesh mesh;
    for (int i = -32; i < 32; ++i) {
      const float left = (float(i) + from) * column, right = left + 0.3125F * column;
      const auto first = std::uint32_t(mesh.positions.size());
      for (const glm::vec3& p :
           {glm::vec3(left, -2, z), glm::vec3(right, -2, z), glm::vec3(right, 2, z), glm::vec3(left, 2, z)})
        mesh.positions.push_back(p);
      mesh.triangles.emplace_back(first, first + 1, first + 2);
      mesh.triangles.emplace_back(first, first + 2, first + 3);
    }
    EXPECT_TRUE(finishMesh(mesh).ok());
    const auto shared = std::make_shared<const Mesh>(std::move(mesh));
    test::addSurface(scene, z > 0.0F ? "near slats" : "far slats", shared).albedo = glm::dvec3(0.9);
  }
  return scene;
}

// There are more places with light of their own than pixels in so small a picture, and it is as bright as a large one.
// Broken by: room for as many places as there are pixels (two thirds of the light).
TEST_F(SubpixelsTest, MorePlacesThanPixelsHaveTheirLight) {
  const auto mean = [this](int size, SessionKey session) {
    const FramePtr picture = frame(slats(), sampled(16, glm::ivec2(size)), session);
    double sum = 0.0;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) sum += pixel(*picture, x, y).x;
    }
    return sum / (size * size);
  };
  const double small = mean(64, 1), large = mean(256, 2);
  EXPECT_NEAR(small, large, 0.02 * large);
}

// Half of the light is hidden from the strip, which few rays of each place know.
// Broken by: places whose light is not the mean with those beside them.
TEST_F(SubpixelsTest, AStripInAPenumbraIsEven) {
  Scene scene = fence(40.6, 40.95, 0);
  Surface& blind = test::addSurface(scene, "blind", reference::quad());
  blind.transform.translation = {-0.5, 0.0, 0.5};
  blind.transform.scale = {1.5, 6.0, 1.0};
  blind.visibleToCamera = false;
  const FramePtr picture = frame(scene, sampled(16));
  double sum = 0.0, steps = 0.0;
  for (int y = 16; y < 48; ++y) {
    const double here = pixel(*picture, 40, y).x;
    sum += here;
    steps += std::abs(pixel(*picture, 40, y + 1).x - here);
  }
  RecordProperty("step", std::to_string(steps / sum));
  EXPECT_LT(steps, 0.1 * sum) << steps / sum;  // .07; without means .18
}

// Every transport and lookup: away from edges a sampled picture is the other.
// Broken by: light looked up elsewhere than in the pixel's middle.
TEST_F(SubpixelsTest, FlatPlacesStay) {
  for (const Transport transport : {Transport::kPropagate, Transport::kGather, Transport::kDirect}) {
    Scene scene = test::floorScene(transport, reference::quad());
    scene.options.quality = transport == Transport::kGather ? Quality::kFast : Quality::kAccurate;
    const test::FloorView view = test::floorView(scene, 3.0);
    FrameRequest request = view.frame;
    const FramePtr plain = frame(scene, request, 1);
    request.samples = 4;
    const FramePtr picture = frame(scene, request, 2);
    for (int y = 4; y < 60; y += 3) {
      for (int x = 4; x < 60; x += 3)
        EXPECT_NEAR(pixel(*picture, x, y).x, pixel(*plain, x, y).x, 1e-6 + 2e-6 * pixel(*plain, x, y).x)
            << x << ", " << y;
    }
  }
}

// What a texture has finer than pixels is their mean: stripes of two to a pixel are grey.
// Broken by: one texel per pixel; samples that each blur as far as a whole pixel does not show here, but in the next.
TEST_F(SubpixelsTest, StripesFinerThanPixelsAreGrey) {
  Scene scene = halvedWall(1.0);
  scene.surfaces.erase("right");
  auto wall = std::make_shared<Surface>(*scene.surfaces.at("left"));
  wall->transform = {{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(4.0)};
  const Scene white = [&] {
    Scene out = scene;
    out.surfaces["left"] = wall;
    return out;
  }();
  auto striped = std::make_shared<Surface>(*wall);
  striped->albedoTexture = reference::textureOf(256, 4, [](int x, int) { return glm::dvec3(x % 2); });
  scene.surfaces["left"] = striped;
  const FramePtr grey = frame(scene, sampled(8)), all = frame(white, sampled(1), 2);
  for (int x = 8; x < 56; x += 5) EXPECT_NEAR(pixel(*grey, x, 30).x, 0.5 * pixel(*all, x, 30).x, 0.03) << x;
}

// Stripes as wide as pixels stay stripes: each sample stands for its part of the pixel.
// Broken by: textures that each sample blurs over a whole pixel.
TEST_F(SubpixelsTest, StripesAsWideAsPixelsStaySharp) {
  Scene scene = halvedWall(1.0);
  scene.surfaces.erase("right");
  auto wall = std::make_shared<Surface>(*scene.surfaces.at("left"));
  wall->transform = {{0, 0, 0}, {1, 0, 0, 0}, glm::dvec3(4.0)};
  wall->albedoTexture = reference::textureOf(256, 4, [](int x, int) { return glm::dvec3(x / 4 % 2); });
  scene.surfaces["left"] = wall;
  const FramePtr picture = frame(scene, sampled(16));
  for (int x = 9; x < 56; x += 6) EXPECT_LT(pixel(*picture, x - 1, 30).x, 0.1 * pixel(*picture, x, 30).x) << x;
}

// More pixels than are sampled at a time: the square's edges are where they are in the upper and the lower rows.
// Broken by: rows that begin anew with each band.
TEST_F(SubpixelsTest, LargePicturesAreSampledSomeRowsAtATime) {
  Scene scene = squareAt(0.0);
  test::lightOf(scene).transform.scale = glm::dvec3(3.0);
  const glm::ivec2 size(1536, 1024);  // two bands; a pixel is 4 m / 1024
  const FramePtr picture = frame(scene, sampled(2, size));
  const int left = 768 - 384, top = 512 - 384;
  for (const int y : {top, 400, 681, 682, 683, 700, top + 767}) {
    EXPECT_EQ(pixel(*picture, left, y).x, 4.0) << y;
    EXPECT_EQ(pixel(*picture, left - 1, y).x, 0.0) << y;
  }
  EXPECT_EQ(pixel(*picture, 768, top - 1).x, 0.0);
  EXPECT_EQ(pixel(*picture, 768, top + 768).x, 0.0);
}

// Irradiance frames: pi x radiance / albedo where a surface is seen, else 0.
// Broken by: the light in front; the albedo left in.
TEST_F(SubpixelsTest, FramesOfIrradiance) {
  Scene scene = halvedWall(0.25);
  FrameRequest request = sampled(1);
  const FramePtr seen = frame(scene, request, 1);
  request.quantity = FrameQuantity::kIrradiance;
  const FramePtr received = frame(scene, request, 2);
  const double pi = std::acos(-1.0);
  EXPECT_NEAR(pixel(*received, 10, 32).x, pi * pixel(*seen, 10, 32).x, 1e-5);
  EXPECT_NEAR(pixel(*received, 50, 32).x, pi / 0.25 * pixel(*seen, 50, 32).x, 1e-5);
  Scene before = squareAt(0.0);
  before.options = scene.options;
  Surface& wall = test::addSurface(before, "wall", reference::quad());
  wall.transform.scale = glm::dvec3(4.0);
  wall.transform.translation = {0.0, 0.0, -0.5};
  test::lightOf(before).twoSided = true;
  const FramePtr light = frame(before, request, 3);
  EXPECT_GT(pixel(*light, 20, 32).x, 0.0);
  EXPECT_EQ(pixel(*light, 32, 32), glm::dvec3(0.0));
}

}  // namespace
}  // namespace lpv
