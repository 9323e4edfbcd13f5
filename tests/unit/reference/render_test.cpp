// The double-precision renderer, held to pictures whose pixels are known.
#include "reference/render.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "reference/display.h"
#include "reference/meshes.h"
#include "reference/pipeline.h"
#include "reference/room.h"
#include "reference/sh.h"
#include "reference/texel.h"
#include "reference/volume.h"

namespace lpv::reference {
namespace {

constexpr RenderOptions kSmall{.width = 64, .height = 48};

/// A volume with the same incident radiance in every direction and cell: E = pi L for every normal.
Volume furnace(const Grid& grid, double radiance) {
  Field field(grid.dims);
  for (auto& cell : field.cells) cell.fill({radiance * std::sqrt(4.0 * pi()), 0.0, 0.0, 0.0});
  return toVolume(grid, field);
}

Camera lookingAtTheOrigin(const glm::dvec3& eye) {
  Camera camera;
  camera.eye = eye;
  camera.fovDegrees = 40.0;
  return camera;
}

Scene sceneWith(const std::shared_ptr<Light>& light, const std::shared_ptr<Surface>& surface) {
  Scene scene;
  scene.grid.origin = glm::dvec3(-2.0);
  scene.grid.cell = 0.5;
  scene.grid.dims = glm::ivec3(8);
  if (light) scene.lights["light"] = light;
  if (surface) scene.surfaces["surface"] = surface;
  return scene;
}

std::shared_ptr<Light> squareLight() {
  auto light = std::make_shared<Light>();
  light->mesh = quad();
  light->radiance = {3.0, 2.0, 1.0};
  return light;
}

const glm::dvec3& middle(const Picture& p) { return p.radiance[p.index(p.width / 2, p.height / 2)]; }

std::size_t litPixels(const Picture& p) {
  return std::size_t(std::count_if(p.seen.begin(), p.seen.end(), [](const Seen& s) { return s.object >= 0; }));
}

TEST(ReferenceRender, ASquareCoversTheSquareItShould) {
  const Scene scene = sceneWith(squareLight(), nullptr);
  const RenderOptions large{.width = 300, .height = 200};
  const Picture picture = render(scene, furnace(scene.grid, 0.0), lookingAtTheOrigin({0, 0, 2}), large);
  // 1 m at 2 m distance under 40 degrees: height 200 / (2 * 2 tan 20) = 137.4 pixels.
  const double edge = 200.0 / (4.0 * std::tan(pi() / 9.0));
  EXPECT_NEAR(std::sqrt(double(litPixels(picture))), edge, 1.0);  // pixel centres
  EXPECT_EQ(middle(picture), glm::dvec3(3.0, 2.0, 1.0));
  EXPECT_EQ(picture.radiance[0], glm::dvec3(0.0));
  EXPECT_NEAR(picture.seen[picture.index(150, 100)].depth, 2.0, 1e-12);
}

TEST(ReferenceRender, LightsShineFromTheirFront) {
  Scene scene = sceneWith(squareLight(), nullptr);
  const Volume dark = furnace(scene.grid, 0.0);
  const Camera behind = lookingAtTheOrigin({0, 0, -2});
  EXPECT_GT(litPixels(render(scene, dark, behind, kSmall)), 0U);
  EXPECT_EQ(middle(render(scene, dark, behind, kSmall)), glm::dvec3(0.0));
  RenderOptions open = kSmall;
  open.lightBacksAreOpaque = false;
  EXPECT_EQ(litPixels(render(scene, dark, behind, open)), 0U);
  auto both = squareLight();
  both->twoSided = true;
  scene.lights["light"] = both;
  EXPECT_EQ(middle(render(scene, dark, behind, kSmall)), glm::dvec3(3.0, 2.0, 1.0));
  auto off = squareLight();
  off->enabled = false;
  scene.lights["light"] = off;
  EXPECT_EQ(litPixels(render(scene, dark, lookingAtTheOrigin({0, 0, 2}), kSmall)), 0U);
}

// In a furnace of radiance L a surface of albedo rho shows rho L, whatever its normal.
TEST(ReferenceRender, SurfacesInAFurnaceShowTheirAlbedo) {
  auto ball = std::make_shared<Surface>();
  ball->mesh = sphere();
  ball->albedo = {0.8, 0.4, 0.2};
  const Scene scene = sceneWith(nullptr, ball);
  const Picture picture = render(scene, furnace(scene.grid, 2.0), lookingAtTheOrigin({1, 1, 2}), kSmall);
  ASSERT_GT(litPixels(picture), 300U);
  for (std::size_t i = 0; i < picture.seen.size(); ++i) {
    const glm::dvec3 expected = picture.seen[i].object < 0 ? glm::dvec3(0.0) : 2.0 * ball->albedo;
    for (int c = 0; c < 3; ++c) ASSERT_NEAR(picture.radiance[i][c], expected[c], 1e-6);  // the volume is float
  }
}

// Radiance from +x only: the lit side of a smooth ball follows its interpolated normals.
TEST(ReferenceRender, NormalsAreInterpolatedAndTurnedToTheViewer) {
  auto ball = std::make_shared<Surface>();
  ball->mesh = sphere();
  Scene scene = sceneWith(nullptr, ball);
  const Camera camera = lookingAtTheOrigin({0, 0, 2});
  const Volume volume = furnace(scene.grid, 1.0);
  const Picture smooth = render(scene, volume, camera, kSmall);
  for (const Seen& s : smooth.seen) {
    if (s.object < 0) continue;
    EXPECT_GT(s.normal.z, -0.05);  // interpolated normals lean a little beyond the silhouette
  }
  auto sheet = std::make_shared<Surface>();
  sheet->mesh = quad();
  scene.surfaces["surface"] = sheet;
  const Picture back = render(scene, volume, lookingAtTheOrigin({0, 0, -2}), kSmall);
  EXPECT_NEAR(back.seen[back.index(32, 24)].normal.z, -1.0, 1e-12);
  auto oneSided = std::make_shared<Surface>(*sheet);
  oneSided->twoSided = false;
  scene.surfaces["surface"] = oneSided;
  EXPECT_EQ(litPixels(render(scene, volume, lookingAtTheOrigin({0, 0, -2}), kSmall)), 0U);
}

TEST(ReferenceRender, NonUniformScaleTurnsNormalsByTheInverseTranspose) {
  auto ball = std::make_shared<Surface>();
  ball->mesh = sphereOf(64, 64);
  ball->transform.scale = {1.0, 1.0, 0.25};
  const Scene scene = sceneWith(nullptr, ball);
  const Picture picture = render(scene, furnace(scene.grid, 1.0), lookingAtTheOrigin({0, 0, 2}), kSmall);
  const std::size_t i = picture.index(40, 24);
  ASSERT_EQ(picture.seen[i].object, 0);
  // The point (x, y, z) of the ellipsoid x^2 + y^2 + 16 z^2 = 1/4 has a normal along (x, y, 16 z).
  const double depth = picture.seen[i].depth;
  const double half = std::tan(pi() / 9.0);
  const glm::dvec3 p((2.0 * 40.5 / 64.0 - 1.0) * half * 64.0 / 48.0 * depth, (1.0 - 2.0 * 24.5 / 48.0) * half * depth,
                     2.0 - depth);
  const glm::dvec3 n = glm::normalize(glm::dvec3(p.x, p.y, 16.0 * p.z));
  EXPECT_NEAR(glm::dot(n, picture.seen[i].normal), 1.0, 2e-3);  // 64 facets
}

TEST(ReferenceRender, MirrorsKeepTheOuterSide) {
  auto light = squareLight();
  light->transform.scale = {-1.0, 1.0, 1.0};
  const Scene scene = sceneWith(light, nullptr);
  const Volume dark = furnace(scene.grid, 0.0);
  EXPECT_EQ(middle(render(scene, dark, lookingAtTheOrigin({0, 0, 2}), kSmall)), light->radiance);
}

TEST(ReferenceRender, TexturesAreTheRightWayUpAndLinear) {
  auto light = squareLight();
  auto texture = std::make_shared<Texture>();
  texture->width = 2;
  texture->height = 2;
  texture->texels = {255, 0, 0, 0, 255, 0, 0, 0, 255, 188, 188, 188};  // red, green / blue, grey of about one half
  light->texture = texture;
  light->radiance = glm::dvec3(4.0);
  const Scene scene = sceneWith(light, nullptr);
  const RenderOptions square{.width = 100, .height = 100};
  const Picture picture = render(scene, furnace(scene.grid, 0.0), lookingAtTheOrigin({0, 0, 1.5}), square);
  const auto at = [&](int x, int y) { return picture.radiance[picture.index(x, y)]; };
  const int quarter = int(50.0 * 0.25 / (1.5 * std::tan(pi() / 9.0)));  // pixels to a texel's centre
  EXPECT_GT(at(50 - quarter, 50 - quarter).x, 3.5);
  EXPECT_GT(at(50 + quarter, 50 - quarter).y, 3.5);
  EXPECT_GT(at(50 - quarter, 50 + quarter).z, 3.5);
  EXPECT_NEAR(at(50 + quarter, 50 + quarter).x, 2.0, 0.3);
}

TEST(Bilinear, InterpolatesBetweenTexelCentresAndRepeats) {
  Texture t;
  t.width = 2;
  t.height = 1;
  t.format = TexelFormat::kRgb16F;
  t.texels = {0x00, 0x3c, 0x00, 0x40, 0x01, 0x00, 0x00, 0x42, 0x00, 0x40, 0x00, 0x00};  // (1, 2, 2^-24), (3, 2, 0)
  EXPECT_EQ(bilinear(t, {0.25, 0.5}), glm::dvec3(1.0, 2.0, std::ldexp(1.0, -24)));
  EXPECT_NEAR(bilinear(t, {0.5, 0.5}).x, 2.0, 1e-15);
  EXPECT_NEAR(bilinear(t, {0.0, 0.9}).x, 2.0, 1e-15);
  EXPECT_NEAR(bilinear(t, {-1.75, 7.0}).x, 1.0, 1e-15);
  EXPECT_TRUE(std::isinf(decodeHalf(0xfc00)) && std::isnan(decodeHalf(0x7e00)));
  EXPECT_EQ(decodeHalf(0x7bff), 65504.0);
}

TEST(ReferenceRender, TheRoomShowsAllItsObjectsAndHasInteriors) {
  const Scene room = smallRoom();
  const Picture picture = render(room, furnace(room.grid, 0.5), roomCamera());
  std::vector<int> pixels(room.lights.size() + room.surfaces.size());
  for (const Seen& s : picture.seen) {
    if (s.object >= 0) ++pixels[std::size_t(s.object)];
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) EXPECT_GT(pixels[i], 50) << "object " << i;
  const std::vector<bool> interior = interiorOf(picture);
  const double share = double(std::count(interior.begin(), interior.end(), true)) / double(interior.size());
  EXPECT_GT(share, 0.7);
  EXPECT_LT(share, 0.99);
}

// The lamp hangs below the ceiling and shines down: below it, a surface that looks up gets more than one that looks
// down. (PROPAGATE is diffusion: it takes many more iterations than cells to reach the floor.)
TEST(ReferenceRender, TheRoomIsLitFromItsLamp) {
  Scene room = smallRoom();
  room.options.iterations = 100;
  const Volume volume = transportedVolume(room);
  const Picture picture = render(room, volume, roomCamera());
  double brightest = 0.0;
  for (std::size_t i = 0; i < picture.seen.size(); ++i) {
    const glm::dvec3& c = picture.radiance[i];
    ASSERT_TRUE(std::isfinite(c.x) && c.x >= 0.0 && std::isfinite(c.z) && c.z >= 0.0);
    if (picture.seen[i].object > 0) brightest = std::max(brightest, c.x);
  }
  EXPECT_LT(brightest, 17.0);  // no surface outshines the lamp
  const auto up = lookup(room.grid, fieldOf(volume), Lookup::kSh2, {0.1, -0.3, 0.5}, {0, 1, 0});
  const auto down = lookup(room.grid, fieldOf(volume), Lookup::kSh2, {0.1, -0.3, 0.5}, {0, -1, 0});
  EXPECT_GT(up->x, down->x);
  EXPECT_NEAR(up->x / up->z, 17.0 / 4.0, 1e-3);  // unbounced light keeps the lamp's colour; the volume is float
}

TEST(Display, IsMonotonousAndReachesBothEnds) {
  EXPECT_EQ(displayOf(glm::dvec3(0.0), 0.0), glm::u8vec3(0));
  EXPECT_EQ(displayOf(glm::dvec3(1e300), 0.0), glm::u8vec3(255));
  EXPECT_EQ(displayOf(glm::dvec3(0.1), 3.0), displayOf(glm::dvec3(0.8), 0.0));
  for (int i = 0; i < 256; ++i) EXPECT_NEAR(encodeSrgb(decodeSrgb(i / 255.0)), i / 255.0, 1e-12);
  for (double x = 0.0; x < 20.0; x += 0.01) EXPECT_LE(curve(x), curve(x + 0.01));
}

}  // namespace
}  // namespace lpv::reference
