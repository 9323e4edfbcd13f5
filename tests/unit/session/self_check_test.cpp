// The error a session measures while it runs, against volumes whose error is known.
#include "session/delivery/self_check.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/volume.h"
#include "scene/lookup.h"
#include "scene/receiver_sampler.h"

namespace lpv {
namespace {

constexpr std::uint32_t kSeed = 7;

/// A quad of half a metre in the middle of a room of two, `surfaces` of it lit.
Scene sceneWith(bool surfaces) {
  Scene scene;
  scene.grid = {glm::dvec3(-1.0), 2.0 / 32, glm::ivec3(32)};
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::quad();
  lamp->transform.scale = glm::dvec3(0.25);
  lamp->transform.rotation = rotationFromEulerDegrees({35, 20, -50});
  lamp->radiance = {4, 2, 1};
  scene.lights["lamp"] = lamp;
  if (surfaces) {
    auto wall = std::make_shared<Surface>();
    wall->name = "wall";
    wall->mesh = reference::quadOf(4);
    wall->transform.scale = glm::dvec3(0.8);
    wall->transform.translation.z = 0.7;  // before the light
    scene.surfaces["wall"] = wall;
  }
  return scene;
}

std::vector<reference::Emitter> emittersOf(const Scene& scene) {
  std::vector<reference::Emitter> out;
  for (const auto& [name, light] : scene.lights) {
    const auto some = reference::emittersOf(scene.grid, *light->mesh, light->transform.worldFromObject(),
                                            emittedRadiance(*light), light->twoSided);
    out.insert(out.end(), some.triangles.begin(), some.triangles.end());
  }
  return out;
}

/// The exact field at cell centres, times `factor`.
Volume exactVolume(const Scene& scene, double factor) {
  const std::vector<reference::Emitter> emitters = emittersOf(scene);
  reference::Field field(scene.grid.dims);
  reference::forEachCell(scene.grid.dims, [&](const glm::ivec3& cell) {
    field.at(cell) = reference::incidentSh(emitters, scene.grid.cellCentre(cell));
    for (reference::Coefficients& c : field.at(cell)) c *= factor;
  });
  return reference::toVolume(scene.grid, field);
}

// Broken by: the truth of one side for both; normals away from where the volume is read; got for truth below the line.
TEST(SelfCheck, FindsTheErrorThatIsThere) {
  for (const bool surfaces : {false, true}) {
    for (const bool twoSided : {false, true}) {
      Scene scene = sceneWith(surfaces);
      auto lamp = std::make_shared<Light>(*scene.lights["lamp"]);
      lamp->twoSided = twoSided;
      lamp->transform.scale.x = twoSided ? -0.25 : 0.25;
      scene.lights["lamp"] = lamp;
      // Up to 2 cells from a light the field bends within cells, and beside it the cap is its own error.
      const std::optional<ErrorEstimate> exact = selfCheck(scene, exactVolume(scene, 1.0), kSeed);
      ASSERT_TRUE(exact.has_value());
      EXPECT_LE(exact->error, 0.06);
      const std::optional<ErrorEstimate> wrong = selfCheck(scene, exactVolume(scene, 1.5), kSeed);
      ASSERT_TRUE(wrong.has_value());
      EXPECT_NEAR(wrong->error, 0.5, 0.06);
    }
  }
}

/// The lamp as receivers near it look at it, and the lamp near everywhere.
EmitterListPtr nearEverywhere(const Scene& scene) {
  auto list = std::make_shared<EmitterList>();
  list->grid = scene.grid;
  const std::vector<reference::Emitter> emitters = emittersOf(scene);
  list->texels = {{1, 0, 0, 0}, glm::vec4(scene.lights.at("lamp")->radiance, 0), {3, float(emitters.size()), 1, 0}};
  for (const reference::Emitter& e : emitters) {
    for (const glm::dvec3& corner : e.corners)
      list->texels.emplace_back(glm::vec3(scene.grid.gridFromWorld(corner)), 0.0F);
  }
  list->emitterDistance.assign(scene.grid.cells(), 0.0F);
  return list;
}

// As frames of any quality do. Broken by: the near field with quality ACCURATE alone.
TEST(SelfCheck, LooksAtNearLightsInEveryQuality) {
  for (const Quality quality : {Quality::kFast, Quality::kAccurate}) {
    Scene scene = sceneWith(true);
    scene.options.quality = quality;
    Volume wrong = exactVolume(scene, 1.5);
    wrong.direct = nearEverywhere(scene);
    const std::optional<ErrorEstimate> found = selfCheck(scene, wrong, kSeed);
    ASSERT_TRUE(found.has_value());
    EXPECT_LE(found->error, 1e-5);
  }
}

TEST(SelfCheck, IsTheSameForTheSameSeed) {
  const Scene scene = sceneWith(true);
  const Volume volume = exactVolume(scene, 1.1);
  EXPECT_EQ(selfCheck(scene, volume, 1)->error, selfCheck(scene, volume, 1)->error);
  EXPECT_NE(selfCheck(scene, volume, 1)->error, selfCheck(scene, volume, 2)->error);
}

// Broken by: a texture taken for white.
TEST(SelfCheck, SaysNothingWhereThereIsNoTruth) {
  const Scene scene = sceneWith(false);
  const Volume volume = exactVolume(scene, 1.0);
  const auto with = [&](const auto& change) {
    Scene other = scene;
    auto lamp = std::make_shared<Light>(*scene.lights.at("lamp"));
    change(*lamp);
    other.lights["lamp"] = lamp;
    return selfCheck(other, volume, kSeed);
  };
  EXPECT_TRUE(with([](Light&) {}).has_value());
  EXPECT_FALSE(with([](Light& l) { l.enabled = false; }).has_value());
  EXPECT_FALSE(with([](Light& l) { l.radiance = glm::dvec3(0.0); }).has_value());
  EXPECT_FALSE(with([](Light& l) { l.texture = std::make_shared<Texture>(); }).has_value());
  EXPECT_FALSE(with([](Light& l) {
                 auto mesh = std::make_shared<Mesh>(*l.mesh);
                 mesh->directions.assign(mesh->positions.size(), glm::vec3(0, 0, 1));
                 l.mesh = mesh;
               }).has_value());
}

/// A quad of `half` m that faces down, over a floor of two triangles 2 x `floor` m wide at y = 0.
Scene lampOverFloor(double half, double height, double floor) {
  Scene scene;
  scene.grid = {glm::dvec3(-floor, 0.0, -floor), 2.0 * floor / 32, glm::ivec3(32, 4, 32)};
  auto lamp = std::make_shared<Light>();
  lamp->mesh = reference::quad();
  lamp->transform.scale = glm::dvec3(2.0 * half);
  lamp->transform.rotation = rotationFromEulerDegrees({90, 0, 0});
  lamp->transform.translation = {0.0, height, 0.0};
  lamp->radiance = {6, 5, 4};
  scene.lights["lamp"] = lamp;
  auto ground = std::make_shared<Surface>();
  ground->mesh = reference::quad();
  ground->transform.scale = glm::dvec3(2.0 * floor);
  ground->transform.rotation = rotationFromEulerDegrees({-90, 0, 0});
  ground->twoSided = false;
  scene.surfaces["ground"] = ground;
  return scene;
}

/// The integral of irradiance and of its square over the floor, mean of the colours, by rings about the lamp's foot.
double received(const AreaLights& lights, double floor) {
  double sum = 0.0;
  const int n = 400;
  const double edge = 2.0 * floor / n;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      const glm::dvec3 p((i + 0.5) * edge - floor, 0.0, (j + 0.5) * edge - floor);
      const glm::dvec3 e = lights.irradiance({p, {0.0, 1.0, 0.0}});
      sum += edge * edge * (e.x + e.y + e.z) / 3.0;
    }
  }
  return sum;
}

// Where rays cross the floor is where its light falls: as many as the light's power and the floor's share of it say.
// Broken by: directions uniform over the hemisphere; the back of the quad for its front.
TEST(ReceiverSampler, RaysFallAsTheLightDoes) {
  const Scene scene = lampOverFloor(0.1, 1.0, 2.0);
  const AreaLights lights(scene);
  const LitSides sides(scene);
  EXPECT_NEAR(sides.area(), 16.0, 1e-9);
  EXPECT_NEAR(lights.power(), 5.0 * std::numbers::pi * 0.04, 1e-9);
  Random random(3);
  std::vector<Receiver> met;
  const int rays = 20'000;
  for (int i = 0; i < rays; ++i) {
    glm::dvec3 origin, direction;
    lights.emit(random, &origin, &direction);
    EXPECT_NEAR(glm::length(direction), 1.0, 1e-9);
    sides.cross(origin, direction, &met);
  }
  EXPECT_NEAR(lights.power() * double(met.size()) / rays, received(lights, 2.0), 0.015 * received(lights, 2.0));
  for (const Receiver& at : met) EXPECT_NEAR(at.position.y, 0.0, 1e-9);
}

// Broken by: triangles alike by number; one side for both.
TEST(ReceiverSampler, PointsFollowArea) {
  Scene scene = lampOverFloor(0.1, 1.0, 2.0);
  auto tile = std::make_shared<Surface>(*scene.surfaces["ground"]);
  tile->transform.scale = glm::dvec3(2.0);
  tile->transform.translation.y = 0.5;
  tile->twoSided = true;
  scene.surfaces["tile"] = tile;
  const LitSides sides(scene);
  EXPECT_NEAR(sides.area(), 16.0 + 2.0 * 4.0, 1e-9);
  Random random(5);
  int above = 0, upwards = 0;
  for (int i = 0; i < 6000; ++i) {
    const Receiver at = sides.sample(random);
    above += at.position.y > 0.25;
    upwards += at.normal.y > 0.0;
  }
  EXPECT_NEAR(above / 6000.0, 8.0 / 24.0, 0.03);
  EXPECT_NEAR(upwards / 6000.0, 20.0 / 24.0, 0.03);
}

/// Relative L2 over both sides of the wall of sceneWith(true), by a fine raster.
double errorOverWall(const Scene& scene, const Volume& volume) {
  const AreaLights lights(scene);
  double apart = 0.0, whole = 0.0;
  const int n = 160;
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < n; ++j) {
      for (const double side : {-1.0, 1.0}) {
        const Receiver at{{0.8 * ((i + 0.5) / n - 0.5), 0.8 * ((j + 0.5) / n - 0.5), 0.7}, {0.0, 0.0, side}};
        const glm::dvec3 truth = lights.irradiance(at);
        const glm::dvec3 got = irradianceAt(volume, scene.options.lookup, at.position, at.normal).rgb;
        apart += glm::dot(got - truth, got - truth);
        whole += glm::dot(truth, truth);
      }
    }
  }
  return std::sqrt(apart / whole);
}

// Broken by: sides alike for both; points weighted by 1; the interval of one group alone.
TEST(SelfCheck, ItsIntervalHoldsTheErrorOfTheWholeSurface) {
  const Scene scene = sceneWith(true);
  // Wrong in one half of the room only.
  Volume volume = exactVolume(scene, 1.0);
  for (VolumeLayer& layer : volume.layers) {
    for (std::size_t i = 0; i < layer.coefficients.size(); ++i) {
      if (i / 12 % 32 < 14) layer.coefficients[i] *= 1.3F;
    }
  }
  const double expected = errorOverWall(scene, volume);
  EXPECT_GT(expected, 0.1);
  int inside = 0;
  for (std::uint32_t seed = 1; seed <= 100; ++seed) {
    const std::optional<ErrorEstimate> found = selfCheck(scene, volume, seed);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->error, expected, 0.3 * expected);
    inside += found->low <= expected && expected <= found->high;
  }
  EXPECT_GE(inside, 90) << "of 100";
}

/// Relative L2 over the floor within `radius` m of the lamp's foot, by rings that grow outwards.
double errorOverFloor(const Scene& scene, const Volume& volume, double radius) {
  const AreaLights lights(scene);
  double apart = 0.0, whole = 0.0;
  const double growth = 1.02;
  for (double r = 0.01; r < radius; r *= growth) {
    for (int i = 0; i < 48; ++i) {
      const double angle = 2.0 * std::numbers::pi * (i + 0.5) / 48, middle = 0.5 * (1.0 + growth) * r;
      const Receiver at{{middle * std::cos(angle), 0.0, middle * std::sin(angle)}, {0.0, 1.0, 0.0}};
      const glm::dvec3 truth = lights.irradiance(at);
      const glm::dvec3 got = irradianceAt(volume, scene.options.lookup, at.position, at.normal).rgb;
      apart += r * r * glm::dot(got - truth, got - truth);
      whole += r * r * glm::dot(truth, truth);
    }
  }
  return std::sqrt(apart / whole);
}

// A lamp of .2 m 6 m over 200 m of floor: nearly all light falls on a thousandth of it, and nearly all of the error is
// there. Broken by: uniform points alone, which are next to never in it.
TEST(SelfCheck, FindsTheSpotOnALargeFloor) {
  const Scene scene = lampOverFloor(0.1, 6.0, 100.0);
  Volume volume = exactVolume(scene, 1.0);
  for (const int x : {15, 16}) {
    for (const int z : {15, 16}) {
      const std::size_t lowest = std::size_t(z * 4 * 32 + x) * 12;
      for (std::size_t i = 0; i < 12; ++i) volume.layers[0].coefficients[lowest + i] *= 8.0F;
    }
  }
  const double expected = errorOverFloor(scene, volume, 100.0);
  for (std::uint32_t seed = 1; seed <= 20; ++seed) {
    const std::optional<ErrorEstimate> found = selfCheck(scene, volume, seed);
    ASSERT_TRUE(found.has_value());
    EXPECT_NEAR(found->error, expected, 0.25 * expected) << seed;
  }
}

// Broken by: weights that leave the rays' density out.
TEST(ErrorEstimate, OfPointsWithTwoDensitiesIsThatOfTheWhole) {
  // On [0, 1]: truth t = x^4, got = t (1 + x / 4). Half uniform, half with the density 5 x^4 of the truth.
  const double true2 = 1.0 / 9.0, apart2 = 1.0 / 16.0 / 11.0;
  const double expected = std::sqrt(apart2 / true2);
  int inside = 0;
  double mean = 0.0;
  for (std::uint32_t seed = 0; seed < 300; ++seed) {
    Random random(seed);
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    std::vector<std::vector<Compared>> groups(2);
    for (int i = 0; i < 128; ++i) {
      const double x = i % 2 == 0 ? unit(random) : std::pow(unit(random), 0.2);
      const double truth = std::pow(x, 4.0);
      groups[std::size_t(i % 2)].push_back(
          {glm::dvec3(truth * (1.0 + x / 4.0)), glm::dvec3(truth), 1.0 / (64.0 + 64.0 * 5.0 * truth)});
    }
    const std::optional<ErrorEstimate> found = estimateError(groups, seed);
    ASSERT_TRUE(found.has_value());
    EXPECT_LE(found->low, found->error);
    EXPECT_GE(found->high, found->error);
    inside += found->low <= expected && expected <= found->high;
    mean += found->error / 300.0;
  }
  EXPECT_NEAR(mean, expected, 0.005 * expected);
  EXPECT_GE(inside, 270) << "of 300 intervals of 95 %";
}

TEST(ErrorEstimate, IsNoneWithoutLight) {
  EXPECT_FALSE(estimateError({{}, {{glm::dvec3(1.0), glm::dvec3(0.0), 1.0}}}, 1).has_value());
}

}  // namespace
}  // namespace lpv
