// All the light at a point, against what falls there on surfaces that face every way: E_lm = A_l L_lm with
// A = pi, 2 pi / 3, pi / 4 (Ramamoorthi & Hanrahan 2001).
#include "scene/light_around.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

#include "reference/direct_texels.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/shadowed.h"

namespace lpv {
namespace {

constexpr int kNormals = 4000;

/// Of one colour, from the irradiance for each normal.
template <typename Irradiance>
Harmonics deconvolved(const Irradiance& irradiance, int normals = kNormals) {
  const double pi = glm::pi<double>(), lobe[] = {pi, 2.0 * pi / 3.0, pi / 4.0};
  Harmonics out{};
  for (int k = 0; k < normals; ++k) {
    const glm::dvec3 n = directionAround(k, normals);
    const double e = irradiance(n) * 4.0 * pi / normals;
    const Harmonics y = harmonicsOf(n);
    for (std::size_t i = 0; i < out.size(); ++i) out[i] += e * y[i] / lobe[i == 0 ? 0 : i < 4 ? 1 : 2];
  }
  return out;
}

/// The largest difference, as a share of the first coefficient.
double apart(const LightAround& got, const Harmonics& want, int colour = 0) {
  double out = 0.0;
  for (std::size_t i = 0; i < want.size(); ++i) out = std::max(out, std::abs(got.radiance[i][colour] - want[i]));
  return out / want[0];
}

/// A square of 1 m at z = 0 that shines towards +z.
reference::DirectLight square() {
  reference::DirectLight light;
  light.radiance = glm::dvec3(1.0, 0.5, 0.25);
  const glm::dvec3 a(-0.5, -0.5, 0), b(0.5, -0.5, 0), c(0.5, 0.5, 0), d(-0.5, 0.5, 0);
  light.triangles = {{a, b, c}, {a, c, d}};
  return light;
}

/// Cells of 1 m about the origin: grid space is world space.
EmitterList listOf(const std::vector<reference::DirectLight>& lights, double k = 4.0) {
  EmitterList list;
  list.grid = {glm::dvec3(0.0), 1.0, glm::ivec3(8)};
  list.always = true;
  list.texels = reference::directTexels(lights, k);
  return list;
}

LightAround around(const EmitterList& list, const glm::dvec3& at) {
  Volume volume;
  volume.direct = std::make_shared<const EmitterList>(list);
  const LightAnswer answer = lightAround(volume, Lookup::kCap, at, false);
  EXPECT_TRUE(answer.valid);
  return answer.light;
}

TEST(Harmonics, AreOrthonormal) {
  std::array<Harmonics, 9> products{};
  for (int k = 0; k < kNormals; ++k) {
    const Harmonics y = harmonicsOf(directionAround(k, kNormals));
    for (std::size_t i = 0; i < 9; ++i) {
      for (std::size_t j = 0; j < 9; ++j) products[i][j] += y[i] * y[j] * 4.0 * glm::pi<double>() / kNormals;
    }
  }
  for (std::size_t i = 0; i < 9; ++i) {
    for (std::size_t j = 0; j < 9; ++j) EXPECT_NEAR(products[i][j], i == j ? 1.0 : 0.0, 2e-3) << i << ' ' << j;
  }
}

// The numbers that result.proto writes out. Broken by: another order, a sign, y and z exchanged.
TEST(LightAround, OfASquareOverhead) {
  reference::DirectLight light;
  light.radiance = glm::dvec3(1.0);
  const glm::dvec3 a(-0.5, 1, -0.5), b(0.5, 1, -0.5), c(0.5, 1, 0.5), d(-0.5, 1, 0.5);
  light.triangles = {{a, b, c}, {a, c, d}};  // front down
  const LightAround got = around(listOf({light}), glm::dvec3(0.0));
  const double want[] = {0.2272, 0.3676, 0, 0, 0, 0, -0.2060, 0, -0.3568};
  for (std::size_t i = 0; i < 9; ++i) EXPECT_NEAR(got.radiance[i].x, want[i], 5e-4) << i;
  const MainLight main = got.mainLight();
  EXPECT_NEAR(main.direction.y, 1.0, 1e-9);
  EXPECT_NEAR(main.irradiance.x, 0.7031, 1e-4);
}

// From 5 cm to 3 m, beside and behind. Broken by: triangles that are never cut (a third of the first coefficient).
TEST(LightAround, OfASquareIsWhatFallsOnSurfaces) {
  const EmitterList list = listOf({square()});
  double largest = 0.0;
  for (const glm::dvec3& at : {glm::dvec3(0, 0, 3), glm::dvec3(0, 0, 1), glm::dvec3(0.2, 0.1, 0.3),
                               glm::dvec3(0.4, 0.4, 0.05), glm::dvec3(0.9, 0.2, 0.1), glm::dvec3(-2, 1, 0.5)}) {
    const LightAround got = around(list, at);
    const Harmonics want = deconvolved([&](const glm::dvec3& n) { return list.irradiance(at, n).x; });
    largest = std::max(largest, apart(got, want));
    EXPECT_NEAR(got.radiance[0].z, 0.25 * got.radiance[0].x, 1e-12) << "colours";
  }
  EXPECT_LE(largest, 0.01);
  EXPECT_EQ(around(list, {0, 0, -1}).radiance[0], glm::dvec3(0.0)) << "behind";
}

// Trees and their VPLs; band 2 of a VPL is that of a cap.
// Broken by: a VPL without its colour, or with fluence alone.
TEST(LightAround, OfTreesIsWhatFallsOnSurfaces) {
  for (const bool coloured : {false, true}) {
    const EmitterList list = listOf({reference::randomTree(coloured, true, 2.0, 5)}, 2.0);
    for (const glm::dvec3& at : {glm::dvec3(5, 1, 1), glm::dvec3(-2, -3, 6), glm::dvec3(1, 4, 0)}) {
      const LightAround got = around(list, at);
      for (const int colour : {0, 2}) {
        const Harmonics want = deconvolved([&](const glm::dvec3& n) { return list.irradiance(at, n)[colour]; });
        EXPECT_LE(apart(got, want, colour), 0.02) << coloured << colour << at.x;
      }
    }
  }
}

Transform placed(const glm::dvec3& translation, double degrees, double scale) {
  return {translation, rotationFromEulerDegrees({degrees, 0.0, 0.0}), glm::dvec3(scale)};
}

/// A lamp of 1 m, front down, 2 m above the origin; a plate of half a metre, with `albedo`, between them.
Scene lampAndPlate() {
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::quad();
  lamp->transform = placed({0, 0, 2}, 180.0, 1.0);
  scene.lights["lamp"] = lamp;
  auto surface = std::make_shared<Surface>();
  surface->name = "plate";
  surface->mesh = reference::quad();
  surface->transform = placed({0.1, 0, 1}, 0.0, 0.5);
  scene.surfaces["plate"] = surface;
  return scene;
}

// The half of a light that is seen is where the light comes from.
// Broken by: one share for the whole light (a seventh of the first coefficient).
TEST(LightAround, ShadowsTakeTheirPartOfTheLight) {
  const Scene scene = lampAndPlate();
  reference::DirectLight lamp = square();
  for (auto& triangle : lamp.triangles) {
    for (glm::dvec3& corner : triangle) corner = {corner.x, -corner.y, 2.0};
  }
  EmitterList list = listOf({lamp});
  list.visibility = std::make_shared<const LightVisibility>(std::make_shared<const Scene>(scene));
  const reference::ShadowedLights truth(scene, 16);
  int inBetween = 0;
  for (const glm::dvec3& at : {glm::dvec3(0, 0, 0), glm::dvec3(0.3, 0, 0), glm::dvec3(0.6, 0.1, 0.2),
                               glm::dvec3(-0.4, -0.3, 0.5), glm::dvec3(1.5, 0, 0)}) {
    const LightAround got = around(list, at);
    const Harmonics want = deconvolved([&](const glm::dvec3& n) { return truth.irradiance({at, n}).x; }, 600);
    const Harmonics open = deconvolved([&](const glm::dvec3& n) { return list.unoccluded(at, n).x; }, 600);
    EXPECT_LE(apart(got, want) * want[0], 0.04 * open[0]) << at.x;  // a row of a light's points is 6 % of it
    inBetween += want[0] > 0.05 * open[0] && want[0] < 0.95 * open[0] ? 1 : 0;
  }
  EXPECT_GE(inBetween, 3);
}

/// A wall of 2 x 2 m at z = 0, front up, that sends radiance 1.
ReflectedLight shiningWall() {
  Scene scene;
  auto wall = std::make_shared<Surface>();
  wall->name = "wall";
  wall->mesh = reference::quad();
  wall->transform = placed({0, 0, 0}, 0.0, 2.0);
  wall->twoSided = false;
  scene.surfaces["wall"] = wall;
  ReflectedLight light;
  light.of = std::make_shared<const PatchedScene>(PatchedScene{patchesOf(scene, 512), {}});
  light.radiance.assign(light.of->patches.size(), glm::dvec3(1.0));
  return light;
}

// Broken by: points for patches from near; patches seen from behind.
TEST(LightAround, OfALitWallIsThatOfALight) {
  reference::DirectLight light = square();
  light.radiance = glm::dvec3(1.0);
  for (auto& triangle : light.triangles) {
    for (glm::dvec3& corner : triangle) corner *= 2.0;
  }
  const ReflectedLight wall = shiningWall();
  for (const glm::dvec3& at : {glm::dvec3(0, 0, 1), glm::dvec3(0.3, 0.1, 0.05), glm::dvec3(1.4, 0, 0.4)}) {
    const LightAround want = around(listOf({light}), at), got = wall.around(at, nullptr);
    for (std::size_t i = 0; i < 9; ++i)
      EXPECT_NEAR(got.radiance[i].x, want.radiance[i].x, 0.01 * want.radiance[0].x) << at.x << ' ' << i;
  }
  EXPECT_EQ(wall.around({0, 0, -1}, nullptr).radiance[0], glm::dvec3(0.0));
}

// Broken by: the first colour's direction for all; an irradiance below 0.
TEST(LightAround, TheMainLightIsWhereMostComesFrom) {
  const glm::dvec3 up(0, 1, 0), right(1, 0, 0);
  LightAround light;
  light.addFrom(up, {1, 0, 0});
  EXPECT_NEAR(glm::dot(light.mainLight().direction, up), 1.0, 1e-12);
  EXPECT_NEAR(light.mainLight().irradiance.x, 1.0, 1e-12);
  light.addFrom(right, {0, 9, 0});
  EXPECT_GT(glm::dot(light.mainLight().direction, right), 0.99) << "by luminance";
  light.addFrom(-right, {0, 0, 100});
  EXPECT_GE(light.mainLight().irradiance.z, 0.0);
  EXPECT_EQ(LightAround().mainLight().direction, up);
  EXPECT_EQ(LightAround().mainLight().irradiance, glm::dvec3(0.0));
}

// Broken by: an answer beyond the grid.
TEST(LightAround, WithoutLightsIsTheVolumes) {
  Volume volume;
  volume.grid = {glm::dvec3(0.0), 1.0, {2, 1, 1}};
  volume.layers.push_back({"", std::vector<float>(2 * 12)});
  for (std::size_t i = 0; i < 24; ++i) volume.layers[0].coefficients[i] = float(i);
  const LightAnswer answer = lightAround(volume, Lookup::kCap, {1.0, 0.5, 0.5}, false);
  EXPECT_TRUE(answer.valid);
  EXPECT_EQ(answer.light.radiance[0], glm::dvec3(6, 10, 14));
  EXPECT_EQ(answer.light.radiance[3], glm::dvec3(9, 13, 17));
  EXPECT_EQ(answer.light.radiance[4], glm::dvec3(0.0));
  EXPECT_FALSE(lightAround(volume, Lookup::kCap, {3.0, 0.5, 0.5}, false).valid);
}

// A box of 1 m that can be seen from outside: from inside all are backs.
TEST(BackFaces, AreMetInsideOfSomethingSolid) {
  Scene scene;
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  auto box = std::make_shared<Surface>();
  box->name = "box";
  box->mesh = reference::box(glm::dvec3(-0.5), glm::dvec3(0.5));
  scene.surfaces["box"] = box;
  EmitterList list = listOf({square()});
  Volume volume;
  volume.direct = std::make_shared<const EmitterList>(list);
  EXPECT_EQ(backFacesAround(volume, glm::dvec3(0.0)), 0) << "nothing is in the way of light";
  list.visibility = std::make_shared<const LightVisibility>(std::make_shared<const Scene>(scene));
  volume.direct = std::make_shared<const EmitterList>(list);
  EXPECT_EQ(backFacesAround(volume, {0.1, 0.2, -0.3}), kRaysAround);
  EXPECT_EQ(backFacesAround(volume, {0.0, 0.0, 1.0}), 0);
}

}  // namespace
}  // namespace lpv
