// What is predicted of a scene's error, against brute force: the exact field at the cells' centres, looked up over a
// fine raster of the surfaces.
#include "scene/predicted_error.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/error_goal.h"
#include "scene/forecast.h"
#include "scene/grid_choice.h"
#include "scene/lookup.h"
#include "scene/small_lights.h"

namespace lpv {
namespace {

LightPtr lampAt(double edge, const glm::dvec3& at, const glm::dvec3& degrees = {90, 0, 0}) {
  auto out = std::make_shared<Light>();
  out->mesh = reference::quad();
  out->transform.scale = glm::dvec3(edge);
  out->transform.rotation = rotationFromEulerDegrees(degrees);
  out->transform.translation = at;
  out->radiance = {6, 5, 4};
  return out;
}

SurfacePtr wallAt(double edge, const glm::dvec3& at, const glm::dvec3& degrees) {
  auto out = std::make_shared<Surface>();
  out->mesh = reference::quad();
  out->transform.scale = glm::dvec3(edge);
  out->transform.rotation = rotationFromEulerDegrees(degrees);
  out->transform.translation = at;
  out->twoSided = false;
  return out;
}

/// A lamp that faces down over a floor about the origin.
Scene lampOverFloor(double edge, double height, double floor) {
  Scene scene;
  scene.lights["lamp"] = lampAt(edge, {0.0, height, 0.0});
  scene.surfaces["floor"] = wallAt(floor, glm::dvec3(0.0), {-90, 0, 0});
  return scene;
}

Scene fittedTo(Scene scene, int cells) {
  GridOptions options;
  options.longest = cells;
  scene.grid = *fitGrid(options, contentBounds(scene));
  return scene;
}

std::vector<reference::Emitter> emittersOf(const Scene& scene, const Light& light) {
  return reference::emittersOf(scene.grid, *light.mesh, light.transform.worldFromObject(), emittedRadiance(light),
                               light.twoSided)
      .triangles;
}

/// The exact field at a centre, trilinear, one cap; and the lights themselves near them, and where they are small.
glm::dvec3 emulated(const Scene& scene, const std::vector<reference::Emitter>& light, const glm::dvec3& p,
                    const glm::dvec3& n, double distance) {
  const glm::dvec3 truth = reference::irradianceOf(light, p, n);
  const glm::dvec3 g = scene.grid.gridFromWorld(p) - 0.5;
  if (glm::any(glm::lessThan(g, glm::dvec3(0.0))) || glm::any(glm::greaterThan(g, glm::dvec3(scene.grid.dims - 1))))
    return truth;
  const double lookedAt = lookedAtShares(lightSizes(scene, scene.grid)).front();
  const double far = (1.0 - lookedAt) * glm::smoothstep(kNearFieldBegin, kNearFieldEnd, distance / scene.grid.cell);
  glm::dvec3 got(0.0);
  std::array<reference::Coefficients, 3> sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 cell = glm::ivec3(glm::floor(g)) + glm::ivec3(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 apart = 1.0 - glm::abs(g - glm::dvec3(cell));
    const auto at = reference::incidentSh(light, scene.grid.cellCentre(cell));
    for (std::size_t colour = 0; colour < 3; ++colour) sum[colour] += apart.x * apart.y * apart.z * at[colour];
  }
  for (int colour = 0; colour < 3; ++colour) got[colour] = irradianceCap(sum[std::size_t(colour)], n);
  return far * got + (1.0 - far) * truth;
}

/// Over the floor, by rings that grow outwards: the error of lampOverFloor without what merging adds.
double bruteError(const Scene& scene, double edge, double height, double floor) {
  const auto light = emittersOf(scene, *scene.lights.at("lamp"));
  double apart = 0.0, whole = 0.0;
  const double growth = 1.03;
  for (double r = 0.01 * height; r < 0.7 * floor; r *= growth) {
    for (int i = 0; i < 64; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / 64, middle = 0.5 * (1.0 + growth) * r;
      const glm::dvec3 p(middle * std::cos(angle), 0.0, middle * std::sin(angle));
      if (std::max(std::abs(p.x), std::abs(p.z)) > 0.5 * floor) continue;
      const glm::dvec2 beside = glm::max(glm::abs(glm::dvec2(p.x, p.z)) - 0.5 * edge, glm::dvec2(0.0));
      const glm::dvec3 truth = reference::irradianceOf(light, p, {0, 1, 0});
      const glm::dvec3 got = emulated(scene, light, p, {0, 1, 0}, std::hypot(glm::length(beside), height));
      apart += r * r * glm::dot(got - truth, got - truth);
      whole += r * r * glm::dot(truth, truth);
    }
  }
  return std::sqrt(apart / whole);
}

// Asked is a factor of 2 where there is half a percent; the sample is held to a quarter. Broken by: points weighted by
// 1; the nearest cell for the eight around; no near field.
TEST(PredictedError, IsThatOfAFineRaster) {
  struct Case {
    double edge, height, floor;
    int cells;
  };
  for (const auto& [edge, height, floor, cells] : {Case{1.0, 2.0, 8.0, 16},
                                                   {1.0, 2.0, 8.0, 32},
                                                   {1.0, 2.0, 8.0, 64},
                                                   {6.0, 6.0, 200.0, 32},
                                                   {6.0, 6.0, 200.0, 64},
                                                   {6.0, 6.0, 200.0, 128},
                                                   {0.5, 1.0, 20.0, 48}}) {
    const Scene scene = fittedTo(lampOverFloor(edge, height, floor), cells);
    const double merging = mergingError(scene.options.openingRatio());
    const double expected = std::hypot(bruteError(scene, edge, height, floor), merging);
    for (std::uint32_t seed = 1; seed <= 8; ++seed) {
      const std::optional<double> got = predictError(scene, scene.grid, scene.options, seed);
      ASSERT_TRUE(got.has_value());
      EXPECT_NEAR(*got, expected, 0.25 * expected + 0.002) << floor << " m, " << cells << " cells, seed " << seed;
    }
  }
}

// Broken by: the volume's error for lamps that receivers look at everywhere.
TEST(PredictedError, IsNoneForAFewSmallLamps) {
  const Scene small = fittedTo(lampOverFloor(0.2, 6.0, 200.0), 32),
              large = fittedTo(lampOverFloor(6.0, 6.0, 200.0), 32);
  EXPECT_EQ(*predictError(small, small.grid, small.options, 1), 0.0);
  EXPECT_GT(*predictError(large, large.grid, large.options, 1), 0.0);
}

TEST(PredictedError, IsTheSameForTheSameSeed) {
  const Scene scene = fittedTo(lampOverFloor(1.0, 2.0, 8.0), 32);
  EXPECT_EQ(*predictError(scene, scene.grid, {}, 1), *predictError(scene, scene.grid, {}, 1));
  EXPECT_NE(*predictError(scene, scene.grid, {}, 1), *predictError(scene, scene.grid, {}, 2));
}

// Broken by: half of a two-sided light's power; the mirrored side.
TEST(PredictedError, MomentsOfATriangleAreTheReferences) {
  const std::array<glm::dvec3, 3> c = {glm::dvec3(0.1, 0.2, 1.0), {1.3, -0.2, 0.7}, {0.4, 1.1, 1.5}};
  for (const auto& corners : {c, {c[0], c[2], c[1]}}) {
    const glm::dvec3 seen[3] = {corners[0], corners[1], corners[2]};
    const reference::Moments front = reference::triangleMoments(corners, glm::dvec3(0.0));
    const reference::Moments back = reference::triangleMoments({corners[0], corners[2], corners[1]}, glm::dvec3(0.0));
    const Arriving one = triangleMoments(seen, 1), two = triangleMoments(seen, 2);
    EXPECT_NEAR(one.fluence, front.fluence, 1e-14);
    EXPECT_NEAR(glm::distance(one.vectorIrradiance, front.vectorIrradiance), 0.0, 1e-14);
    EXPECT_NEAR(two.fluence, front.fluence + back.fluence, 1e-14);
    EXPECT_NEAR(glm::distance(two.vectorIrradiance, front.vectorIrradiance + back.vectorIrradiance), 0.0, 1e-14);
    EXPECT_GT(glm::length(two.vectorIrradiance), 0.1);
  }
}

/// A room of 4 m with a light in it.
Scene roomWith(const MeshPtr& mesh) {
  Scene scene;
  auto light = std::make_shared<Light>();
  light->mesh = mesh;
  light->radiance = glm::dvec3(1.0);
  scene.lights["light"] = light;
  scene.surfaces["floor"] = wallAt(4.0, {0.0, -2.0, 0.0}, {-90, 0, 0});
  scene.surfaces["side"] = wallAt(4.0, {0.0, 0.0, -2.0}, {0, 0, 0});
  return scene;
}

// A sphere of 500,000 triangles is predicted from 96, as one of 80 from all of them. Broken by: the first 96; triangles
// that stand for themselves alone.
TEST(PredictedError, OfALargeMeshIsFromFewOfItsTriangles) {
  const Scene few = fittedTo(roomWith(reference::sphereOf(8, 6)), 24);
  const Scene many = fittedTo(roomWith(reference::sphereOf(1000, 251)), 24);
  ASSERT_LE(AreaLights(few).triangles(), kThinned);
  ASSERT_GE(AreaLights(many).triangles(), 499'000U);
  Random random(1);
  const AreaLights all(many), thin = all.thinned(kThinned, random);
  EXPECT_EQ(thin.triangles(), kThinned);
  EXPECT_NEAR(thin.power(), all.power(), 1e-9 * all.power());
  const double expected = *predictError(few, few.grid, {});
  EXPECT_NEAR(*predictError(many, many.grid, {}), expected, 0.4 * expected);
}

// Broken by: closed forms of every light at every receiver, however many there are.
TEST(PredictedError, IsNoneWhereLightsAreTooManyOrNone) {
  Scene scene = fittedTo(lampOverFloor(1.0, 2.0, 8.0), 32);
  for (int i = 0; i < 400; ++i) scene.lights["lamp" + std::to_string(i)] = scene.lights["lamp"];
  EXPECT_FALSE(predictError(scene, scene.grid, {}).has_value());
  scene.lights.clear();
  EXPECT_FALSE(predictError(scene, scene.grid, {}).has_value());
}

// Two lamps that face each other across a floor are 5 % off in one cap: automatic groups part them, those by hand
// stand. Broken by: one group for all; groups by hand taken for groups by light.
TEST(PredictedError, KnowsWhichLightsShareAGroup) {
  Scene scene;
  scene.lights["left"] = lampAt(1.0, {-3.0, 1.5, 0.0}, {0, 90, 0});
  scene.lights["right"] = lampAt(1.0, {3.0, 1.5, 0.0}, {0, -90, 0});
  scene.surfaces["floor"] = wallAt(4.0, glm::dvec3(0.0), {-90, 0, 0});
  const auto named = [&](const char* left, const char* right) {
    Scene out = scene;
    for (const auto& [name, group] : {std::pair("left", left), {"right", right}}) {
      auto light = std::make_shared<Light>(*scene.lights.at(name));
      light->group = group;
      out.lights[name] = light;
    }
    out = fittedTo(out, 64);
    return *predictError(out, out.grid, {});
  };
  const double together = named("all", "all"), apart = named("a", "b"), automatic = named("", "");
  EXPECT_GT(together, 0.04);
  EXPECT_LT(apart, 0.01);
  EXPECT_EQ(automatic, apart) << "two that do not go together part";
  scene.lights["third"] = lampAt(1.0, {-3.0, 1.6, 0.2}, {0, 90, 0});
  EXPECT_GT(named("", ""), automatic);
  EXPECT_LE(named("", ""), kGroupingError);
}

// Seen with a bunny of 69,451 triangles a millimetre above a floor, looked at as VPLs: 28 % at 32 cells, 21 % at 64,
// wherever receivers look at the lights. Broken by: no figure for it; one for polygons too, or for plain meshes.
TEST(PredictedError, OfALargeTexturedMeshThatTouchesAFloorIsLarge) {
  const auto standing = [](const MeshPtr& mesh, double height, bool textured = true) {
    Scene scene = roomWith(mesh);
    auto light = std::make_shared<Light>(*scene.lights.at("light"));
    if (textured) light->texture = reference::noise(4, 4);
    light->transform.translation = {0.0, height - 2.0 - double(mesh->bounds.min.y), 0.0};
    scene.lights["light"] = light;
    return fittedTo(scene, 32);
  };
  const Scene touching = standing(reference::sphere(), 0.001), apart = standing(reference::sphere(), 0.5);
  EXPECT_GT(*predictError(touching, touching.grid, {}), 0.03);
  EXPECT_LT(*predictError(apart, apart.grid, {}), 0.02);
  EXPECT_LT(*predictError(touching, fittedTo(touching, 96).grid, {}), *predictError(touching, touching.grid, {}));
  for (const MeshPtr& mesh : {reference::pyramid(), reference::sphere()}) {
    const Scene plain = standing(mesh, 0.001, false);
    EXPECT_LT(*predictError(plain, plain.grid, {}), 0.03);
  }
  LightingSettings given;
  given.grid.longest = 32;
  const std::string told = forecast(touching, given).choice;
  EXPECT_NE(told.find("farther from what they nearly touch"), std::string::npos) << told;
}

LightingSettings seeking(double maxError, bool automatic = true) {
  LightingSettings o;
  o.maxError = maxError;
  o.grid.automatic = automatic;
  o.visibility = Visibility::kOff;  // shadows look at the lights, whatever the grid
  return o;
}

int edgeOf(const Grid& grid) { return std::max({grid.dims.x, grid.dims.y, grid.dims.z}); }

// Broken by: the table's 16 for every scene; the dearest that reaches it; less than 32 where nothing is said.
TEST(GridChoice, IsTheFewestCellsThatReachTheWantedError) {
  const Scene easy = lampOverFloor(2.0, 4.0, 4.0), hard = lampOverFloor(1.0, 2.0, 8.0);
  for (const Scene& scene : {easy, hard}) {
    for (const double wanted : {0.03, 0.01, 0.0045}) {
      const GridChoice choice = *chooseGrid(scene, seeking(wanted));
      ASSERT_TRUE(choice.reached);
      EXPECT_LE(*predictError(scene, choice.grid, resolved(seeking(wanted))), wanted);
      for (std::size_t i = 0; i + 1 < choice.tried.size(); ++i) EXPECT_GT(choice.tried[i].error, wanted);
      EXPECT_EQ(edgeOf(choice.grid), choice.tried.back().cells);
      const int unsaid = edgeOf(chooseGrid(scene, seeking(wanted, false))->grid);
      EXPECT_EQ(unsaid, std::clamp(edgeOf(choice.grid), 32, 64));
    }
  }
  EXPECT_EQ(edgeOf(chooseGrid(easy, seeking(0.01))->grid), 16);
  EXPECT_EQ(edgeOf(chooseGrid(hard, seeking(0.01))->grid), 24);
  EXPECT_EQ(edgeOf(chooseGrid(easy, {})->grid), 32);
}

Forecast toldOf(Scene scene, const LightingSettings& options) {
  scene.options = options;
  scene.grid = chooseGrid(scene, options)->grid;
  return forecast(scene, options);
}

// The lamp reaches through the wall: a cap knows no horizon that cuts it, on any grid. Broken by: 128 cells for
// nothing; a refusal.
TEST(GridChoice, ThatReachesNothingIsNotTheDearest) {
  Scene scene;
  scene.lights["lamp"] = lampAt(1.0, {0.0, 3.0, 0.0});
  scene.surfaces["wall"] = wallAt(4.0, {0.0, 1.0, 0.0}, {0, 90, 0});
  ASSERT_TRUE(checkOptions(seeking(0.004)).ok());
  const GridChoice choice = *chooseGrid(scene, seeking(0.004));
  EXPECT_FALSE(choice.reached);
  EXPECT_EQ(choice.tried.size(), 7U);
  EXPECT_LE(edgeOf(choice.grid), 64);
  const Forecast told = toldOf(scene, seeking(0.004));
  EXPECT_GT(told.error, 0.004);
  EXPECT_NE(told.choice.find(" %, and 0.4 % is wanted: transport DIRECT, or bounds"), std::string::npos) << told.choice;
  const std::string coarser = toldOf(scene, seeking(0.01, false)).choice;
  EXPECT_NE(coarser.find("1 % is wanted: 16 cells would ("), std::string::npos) << coarser;
}

// Finer cells keep making it better, and never right. Broken by: the best of all.
TEST(GridChoice, ThatReachesNothingStopsWhereCellsBecomeDear) {
  Scene scene = roomWith(reference::sphere());
  auto textured = std::make_shared<Light>(*scene.lights.at("light"));
  textured->texture = reference::noise(4, 4);
  scene.lights["light"] = textured;
  scene.surfaces["floor"] = wallAt(4.0, {0.0, double(reference::sphere()->bounds.min.y) - 0.001, 0.0}, {-90, 0, 0});
  const GridChoice choice = *chooseGrid(scene, seeking(0.005));
  EXPECT_FALSE(choice.reached);
  EXPECT_LT(choice.tried.back().error, 0.9 * choice.tried[4].error);
  EXPECT_EQ(edgeOf(choice.grid), 64);
}

// Broken by: a choice for what is given.
TEST(GridChoice, LeavesASizeThatWasGiven) {
  const Scene scene = lampOverFloor(0.5, 1.5, 20.0);
  LightingSettings given;
  given.grid.longest = 16;
  EXPECT_EQ(edgeOf(chooseGrid(scene, given)->grid), 16);
  given.grid = {};
  given.grid.dims = {20, 8, 20};
  EXPECT_EQ(chooseGrid(scene, given)->grid.dims, glm::ivec3(20, 8, 20));
}

// Broken by: a reason that is not the scene's.
TEST(Forecast, SaysTheChoiceAndWhy) {
  const auto says = [](const Scene& scene, const LightingSettings& options, const char* text) {
    const std::string choice = toldOf(scene, options).choice;
    EXPECT_NE(choice.find(text), std::string::npos) << choice;
  };
  says(lampOverFloor(2.0, 4.0, 4.0), {},
       "32 cells along the longest edge, the default: predicted error 0.3 %, wanted 3 %.");
  const Scene scene = lampOverFloor(1.0, 2.0, 8.0);
  says(scene, seeking(0.01), "24 cells along the longest edge: 16 are predicted to miss 1 % (1.");
  LightingSettings given;
  given.maxError = 0.01;
  given.grid.longest = 16;
  says(scene, given, "16 cells along the longest edge, as asked for: predicted error 1.");
  says(scene, given, " %, and 1 % is wanted: 24 cells would (0.");
  Scene moved = scene;
  moved.grid = chooseGrid(scene, seeking(0.01))->grid;
  moved.lights["lamp"] = lampAt(2.0, {0.0, 4.0, 0.0});
  moved.surfaces["floor"] = wallAt(4.0, glm::dvec3(0.0), {-90, 0, 0});
  const std::string stale = forecast(moved, seeking(0.01)).choice;
  EXPECT_NE(stale.find("fitted now it would have 16"), std::string::npos) << stale;
  moved.lights.clear();
  EXPECT_NE(forecast(moved, {}).choice.find("nothing to predict from"), std::string::npos);
}

// Broken by: a correction that is not said; one said of another grid.
TEST(Forecast, SaysWhatWasMeasured) {
  const Scene scene = fittedTo(lampOverFloor(0.5, 1.5, 20.0), 48);
  const GridCorrection correction = {32, 0.034, 48};
  EXPECT_EQ(forecast(scene, {}, correction).choice.find("48 cells along the longest edge: measured 3.4 % with 32"), 0U)
      << forecast(scene, {}, correction).choice;
  EXPECT_EQ(forecast(fittedTo(scene, 32), {}, correction).choice.find("measured"), std::string::npos);
}

// Broken by: DIRECT's table for polygons.
TEST(Forecast, OfDirectIsNearlyNothingForPolygons) {
  LightingSettings direct;
  direct.transport = Transport::kDirect;
  EXPECT_LE(forecast(fittedTo(lampOverFloor(0.5, 1.5, 20.0), 16), direct).error, 1e-4);
  EXPECT_EQ(forecast(fittedTo(roomWith(reference::sphere()), 16), direct).error, expectedError(direct, 16));
}

// Broken by: a light that touches the grid taken for one outside; every name.
TEST(Forecast, NamesLightsThatPropagateLeavesOut) {
  Scene scene = fittedTo(lampOverFloor(1.0, 2.0, 8.0), 16);
  const LightingSettings paper = LightingSettings::paper();
  EXPECT_EQ(forecast(scene, paper).choice.find("outside"), std::string::npos);
  EXPECT_EQ(forecast(scene, paper).error, 1.0);
  scene.lights["far"] = lampAt(1.0, {20.0, 2.0, 0.0});
  const auto says = [&](const char* text) {
    const std::string choice = forecast(scene, paper).choice;
    EXPECT_NE(choice.find(text), std::string::npos) << choice;
  };
  says("light far lies outside the grid: PROPAGATE gives it no light.");
  scene.lights["half"] = lampAt(1.0, {scene.grid.bounds().max.x, 2.0, 0.0});
  says("light half lies partly outside the grid: PROPAGATE gives no light to what is outside.");
  for (const char* name : {"farther", "gone", "hidden"}) scene.lights[name] = scene.lights["far"];
  says("lights far, farther, gone and 1 more lie outside the grid: PROPAGATE gives them no light.");
}

}  // namespace
}  // namespace lpv
