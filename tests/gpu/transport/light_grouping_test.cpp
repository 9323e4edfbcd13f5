// Which lights share a volume: by hand, by themselves, or all.
#include "lpv/transport/light_grouping.h"

#include <gmock/gmock.h>

#include <chrono>

#include "gpu/engine/engine_rig.h"
#include "reference/emitter.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "scene/error_goal.h"
#include "scene/lookup.h"

namespace lpv {
namespace {

using ::testing::ElementsAre;
using ::testing::Le;

/// Spheres of half a metre in a cube of 4 m about the origin.
Scene sceneWith(const std::vector<glm::dvec3>& places, Quality quality = Quality::kAccurate) {
  Scene scene;
  scene.revision = 1;
  scene.grid = {glm::dvec3(-2.0), 0.25, glm::ivec3(16)};
  scene.options.quality = quality;
  for (std::size_t i = 0; i < places.size(); ++i) {
    auto light = std::make_shared<Light>();
    light->name = "light " + std::to_string(100 + i);
    light->mesh = reference::sphere();
    light->transform.translation = places[i];
    light->transform.scale = glm::dvec3(0.5);
    light->radiance = glm::dvec3(1.0 + 0.1 * double(i));
    scene.lights[light->name] = light;
  }
  return scene;
}

std::vector<int> groupsOf(const std::vector<EmittingLight>& lights) {
  std::vector<int> groups;
  for (const EmittingLight& light : lights) groups.push_back(light.group);
  return groups;
}

struct GroupedScene {
  explicit GroupedScene(const Scene& scene, const Grouping& previous = {}) : lights(emittingLights(scene, {})) {
    const Grouped grouped = groupLights(scene, lights, previous);
    names = grouped.names;
    sectors = grouped.sectors;
    groups = groupsOf(lights);
    error = groupingError(lights, scene.grid, {groups, sectors});
  }
  std::vector<EmittingLight> lights;
  std::vector<std::string> names;
  Sectors sectors;
  std::vector<int> groups;
  double error;
};

const std::vector<glm::dvec3> kOpposite = {{-1.4, 0.0, 0.0}, {1.4, 0.0, 0.0}};
const std::vector<glm::dvec3> kBeside = {{-1.7, -1.7, -1.7}, {-1.7, -1.7, -1.66}};

// Broken by: one group more or fewer; the radianceScale last.
TEST(Grouping, LightsOnTwoSidesGetAGroupEach) {
  const GroupedScene grouped(sceneWith(kOpposite));
  EXPECT_THAT(grouped.names, ElementsAre("", "auto 2"));
  EXPECT_THAT(grouped.groups, ElementsAre(0, 1));
  EXPECT_LE(grouped.error, kGroupingError);
  EXPECT_GE(groupingError(grouped.lights, sceneWith(kOpposite).grid, {{0, 0}}), 0.05);
}

TEST(Grouping, LightsOnOneSideShareOne) { EXPECT_THAT(GroupedScene(sceneWith(kBeside)).names, ElementsAre("")); }

// Broken by: groups for quality ACCURATE alone; groups for every lookup.
TEST(Grouping, IsForEveryQualityThatLooksUpCaps) {
  EXPECT_THAT(GroupedScene(sceneWith(kOpposite, Quality::kFast)).groups, ElementsAre(0, 1));
  Scene bands = sceneWith(kOpposite);
  bands.options.lookup = Lookup::kSh2;
  EXPECT_THAT(GroupedScene(bands).groups, ElementsAre(0, 0));
}

TEST(Grouping, WhatTheSceneSaysStands) {
  Scene scene = sceneWith(kBeside);
  auto named = std::make_shared<Light>(*scene.lights.begin()->second);
  named->group = "key";
  scene.lights[named->name] = named;
  const GroupedScene grouped(scene);
  EXPECT_THAT(grouped.names, ElementsAre("", "key"));
  EXPECT_THAT(grouped.groups, ElementsAre(1, 0));
}

TEST(Grouping, ManyLightsShareEightGroupsAsWellAsTheyCan) {
  std::vector<glm::dvec3> places;
  for (int i = 0; i < 24; ++i) {
    const double a = 2.0 * 3.14159265358979 * i / 24.0;
    places.emplace_back(1.6 * std::cos(a), 0.8 * std::sin(3.0 * a), 1.6 * std::sin(a));
  }
  const Scene scene = sceneWith(places);
  const GroupedScene grouped(scene);
  EXPECT_THAT(grouped.names.size(), Le(std::size_t(kMaxGroups)));
  EXPECT_LT(grouped.error, 0.5 * groupingError(grouped.lights, scene.grid, {std::vector<int>(24, 0)}));
}

// Broken by: previous groups forgotten; previous groups whatever they cost.
TEST(Grouping, StandsWhileItIsGoodEnough) {
  EXPECT_THAT(GroupedScene(sceneWith(kBeside), {{0, 1}}).groups, ElementsAre(0, 1));
  EXPECT_THAT(GroupedScene(sceneWith(kOpposite), {{0, 0}}).groups, ElementsAre(0, 1));
}

class GroupingEngineTest : public test::EngineTest {};

// Random points between and around two lights, against the truth, for a session that turns accurate.
TEST_F(GroupingEngineTest, AccurateSessionsAreRightBetweenTwoLights) {
  Scene scene = sceneWith({{-0.8, 0.0, 0.0}, {0.8, 0.0, 0.0}}, Quality::kFast);
  const auto emitters = reference::emittersOf(scene).triangles;
  const auto points = reference::objectReceivers(scene.grid, emitters, 300);
  const auto truth = reference::irradiances(emitters, points);
  const auto errorOf = [&] {
    TickRequest request = test::requestOf(scene);
    request.transported = true;
    const TickResult result = run(std::move(request));
    std::vector<glm::dvec3> seen;
    for (const auto& r : points)
      seen.push_back(irradianceAt(*result.transported, Lookup::kCap, r.position, r.normal).rgb);
    return std::pair(result.transported->layers.size(), reference::errors(seen, truth).raw);
  };
  const auto [one, fast] = errorOf();
  EXPECT_EQ(one, 1U);
  EXPECT_GT(fast, 0.04);
  scene.options.quality = Quality::kAccurate;
  ++scene.revision;
  const auto [two, accurate] = errorOf();
  EXPECT_EQ(two, 2U);
  EXPECT_LT(accurate, 0.015);
  ++scene.revision;
  EXPECT_EQ(errorOf(), std::pair(two, accurate));
}

/// `n` panes of .2 m under the ceiling of a room of 4 m, in rows.
Scene ceilingOf(int n, int cells) {
  Scene scene;
  scene.revision = 1;
  scene.grid = {glm::dvec3(-2.0), 4.0 / cells, glm::ivec3(cells)};
  const int across = int(std::ceil(std::sqrt(double(n)))), along = (n + across - 1) / across;
  for (int i = 0; i < n; ++i) {
    auto light = std::make_shared<Light>();
    light->name = "light " + std::to_string(100 + i);
    light->mesh = reference::quad();
    const double x = (i % across + 0.5) / across, z = (i / across + 0.5) / along;
    light->transform.translation = {2.8 * x - 1.4, 1.55, 2.8 * z - 1.4};
    light->transform.rotation = glm::angleAxis(0.5 * 3.14159265358979, glm::dvec3(1.0, 0.0, 0.0));  // faces down
    light->transform.scale = glm::dvec3(0.2);
    scene.lights[light->name] = light;
  }
  return scene;
}

TEST_F(GroupingEngineTest, Probe) {
  for (const int n : {1, 2, 4, 8, 20, 50}) {
    Scene scene = ceilingOf(n, 64);
    const auto emitters = reference::emittersOf(scene).triangles;
    std::vector<reference::Receiver> points;
    for (const auto& r : reference::objectReceivers(scene.grid, emitters, 600))
      if (r.position.y < 1.0) points.push_back(r);
    const auto truth = reference::irradiances(emitters, points);
    const GroupedScene grouped(scene);
    for (int s = 0; s < 5; ++s) printf(" %.4f", groupingError(grouped.lights, scene.grid, {std::vector<int>(std::size_t(n), 0), Sectors(s)}));
    TickRequest request = test::requestOf(scene);
    request.transported = true;
    const auto t0 = std::chrono::steady_clock::now();
    const TickResult result = run(std::move(request));
    const double dt = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
    std::vector<glm::dvec3> seen;
    for (const auto& r : points)
      seen.push_back(irradianceAt(*result.transported, Lookup::kCap, r.position, r.normal).rgb);
    const auto e = reference::errors(seen, truth);
    printf("\n%d lights: %zu layers, sectors %d, expected %.4f, error %.4f worst %.4f, %.2f s\n", n, result.transported->layers.size(), int(grouped.sectors), grouped.error, e.raw, e.worst, dt);
  }
}

}  // namespace
}  // namespace lpv
