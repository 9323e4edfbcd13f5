// Which lights share a volume: by hand, by themselves, or all.
#include "lpv/transport/light_grouping.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <tuple>

#include "gpu/engine/engine_rig.h"
#include "reference/emitter.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "reference/receivers.h"
#include "scene/error_goal.h"
#include "scene/lookup.h"

namespace lpv {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::Le;

constexpr double kPi = 3.14159265358979323846;

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

CellBox cellsOf(const Scene& scene) { return {glm::ivec3(0), scene.grid.dims}; }

struct GroupedScene {
  explicit GroupedScene(const Scene& scene, const Grouping& previous = {})
      : lights(emittingLights(scene, scene.grid, {})) {
    const Grouped grouped = groupLights(scene, cellsOf(scene), lights, previous);
    names = grouped.names;
    sectors = grouped.sectors;
    groups = groupsOf(lights);
    error = groupingError(lights, cellsOf(scene), {groups, sectors});
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
  EXPECT_GE(groupingError(grouped.lights, cellsOf(sceneWith(kOpposite)), {{0, 0}}), 0.05);
}

// Broken by: a group more than reaches the goal; the largest number of groups that is tried.
TEST(Grouping, HasNoMoreGroupsThanTheGoalWants) {
  const Scene scene = sceneWith({kBeside[0], {1.4, 1.4, 1.4}, kBeside[1]});
  const GroupedScene grouped(scene);
  EXPECT_THAT(grouped.groups, ElementsAre(0, 1, 0));
  EXPECT_LE(grouped.error, kGroupingError);
  EXPECT_GT(groupingError(grouped.lights, cellsOf(scene), {{0, 0, 0}}), kGroupingError);
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
  EXPECT_LT(grouped.error, 0.5 * groupingError(grouped.lights, cellsOf(scene), {std::vector<int>(24, 0)}));
}

// Broken by: previous groups forgotten; previous groups whatever they cost.
TEST(Grouping, StandsWhileItIsGoodEnough) {
  EXPECT_THAT(GroupedScene(sceneWith(kBeside), {{0, 1}}).groups, ElementsAre(0, 1));
  EXPECT_THAT(GroupedScene(sceneWith(kOpposite), {{0, 0}}).groups, ElementsAre(0, 1));
}

/// `n` panes of .2 m under the ceiling of a room of 4 m, in rows; they face down.
Scene ceilingOf(int n, int cells) {
  Scene scene;
  scene.revision = 1;
  scene.grid = {glm::dvec3(-2.0), 4.0 / cells, glm::ivec3(cells)};
  const int across = int(std::ceil(std::sqrt(double(n)))), along = (n + across - 1) / across;
  for (int i = 0; i < n; ++i) {
    auto light = std::make_shared<Light>();
    light->name = "light " + std::to_string(1000 + i);
    light->mesh = reference::quad();
    const double x = (i % across + 0.5) / across, z = (double(i / across) + 0.5) / along;
    light->transform.translation = {2.8 * x - 1.4, 1.55, 2.8 * z - 1.4};
    light->transform.rotation = glm::angleAxis(0.5 * kPi, glm::dvec3(1.0, 0.0, 0.0));
    light->transform.scale = glm::dvec3(0.2);
    scene.lights[light->name] = light;
  }
  return scene;
}

// Broken by: layers by direction for few lights; groups for 1,024 lights.
TEST(Grouping, ManyLightsAreInLayersByDirection) {
  EXPECT_EQ(GroupedScene(ceilingOf(8, 64)).sectors, Sectors::kNone);
  for (const int lights : {20, 1024}) {
    const GroupedScene grouped(ceilingOf(lights, 64));
    EXPECT_EQ(grouped.sectors, Sectors::kAroundY) << "all lights are above";
    EXPECT_EQ(grouped.names.size(), 8U);
    EXPECT_EQ(grouped.names.front(), "direction 1");
    EXPECT_THAT(grouped.groups, Each(0));
    EXPECT_LE(grouped.error, 0.02);
  }
}

// Broken by: the best way each time; lights of another number as if nothing were known.
TEST(Grouping, DirectionsStandWhileTheyAreNearlyAsGood) {
  const Scene scene = ceilingOf(20, 64);
  const GroupedScene octants(scene, {std::vector<int>(20, 0), Sectors::kOctants});
  EXPECT_EQ(octants.sectors, Sectors::kOctants) << octants.error;
  EXPECT_EQ(GroupedScene(ceilingOf(21, 64), {std::vector<int>(20, 0), Sectors::kOctants}).sectors, Sectors::kOctants);
  EXPECT_EQ(GroupedScene(scene, {std::vector<int>(20, 0), Sectors::kAroundX}).sectors, Sectors::kAroundY);
  EXPECT_EQ(GroupedScene(ceilingOf(3, 64), {std::vector<int>(3, 0), Sectors::kAroundY}).names.size(), 3U);
}

std::vector<glm::dvec3> lookedUp(const Volume& volume, const std::vector<reference::Receiver>& points) {
  std::vector<glm::dvec3> seen;
  for (const auto& r : points) seen.push_back(irradianceAt(volume, Lookup::kCap, r.position, r.normal).rgb);
  return seen;
}

class GroupingEngineTest : public test::EngineTest {
 protected:
  VolumePtr volumeOf(const Scene& scene, SessionKey session = 1) {
    TickRequest request = test::requestOf(scene, session);
    request.transported = true;
    return run(std::move(request)).transported;
  }
};

// Random points between and around two lights, against the truth; what one group gives is ten times as wrong.
TEST_F(GroupingEngineTest, SessionsAreRightBetweenTwoLights) {
  Scene scene = sceneWith({{-0.8, 0.0, 0.0}, {0.8, 0.0, 0.0}}, Quality::kFast);
  const auto emitters = reference::emittersOf(scene).triangles;
  const auto points = reference::objectReceivers(scene.grid, emitters, 300);
  const auto truth = reference::irradiances(emitters, points);
  for (const Quality quality : {Quality::kFast, Quality::kAccurate}) {
    scene.options.quality = quality;
    ++scene.revision;
    const VolumePtr volume = volumeOf(scene);
    EXPECT_EQ(volume->layers.size(), 2U);
    EXPECT_LT(reference::errors(lookedUp(*volume, points), truth).raw, 0.015);
  }
  for (auto& [name, light] : scene.lights) {
    auto named = std::make_shared<Light>(*light);
    named->group = "all";
    light = named;
  }
  ++scene.revision;
  const VolumePtr shared = volumeOf(scene);
  EXPECT_EQ(shared->layers.size(), 1U);
  EXPECT_GT(reference::errors(lookedUp(*shared, points), truth).raw, 0.04);
}

// Object points with spread normals under panes, full gather and lookup against the closed form. Seen: .10, .25, .11,
// .09 % with a layer for each light, 1.2 and .9 % for 20 and 50 in layers by direction. Broken by: one layer for all.
TEST_F(GroupingEngineTest, ObjectsUnderManyLightsAreNearTheTruth) {
  for (const auto& [lights, layers, bound] :
       {std::tuple(1, 1U, 0.005), {2, 2U, 0.005}, {4, 4U, 0.005}, {8, 8U, 0.005}, {20, 8U, 0.02}, {50, 8U, 0.02}}) {
    const Scene scene = ceilingOf(lights, 64);
    const auto emitters = reference::emittersOf(scene).triangles;
    auto points = reference::objectReceivers(scene.grid, emitters, 600);
    std::erase_if(points, [](const reference::Receiver& r) { return r.position.y > 1.0; });  // what stands in the room
    const VolumePtr volume = volumeOf(scene, SessionKey(lights));
    EXPECT_EQ(volume->layers.size(), layers) << lights;
    const double error = reference::errors(lookedUp(*volume, points), reference::irradiances(emitters, points)).raw;
    EXPECT_LE(error, bound) << lights;
    RecordProperty("lights" + std::to_string(lights), std::to_string(error));
  }
}

// A light slides over two cells and so over borders of sectors of all receivers: beside what changes in truth, no
// receiver changes from step to step by more than .5 % of the largest. Seen: .3 %. Broken by: borders without a width.
TEST_F(GroupingEngineTest, ALightThatCrossesBordersDoesNotJump) {
  constexpr int kSteps = 24;
  Scene scene = ceilingOf(20, 32);
  const auto move = [&scene](double cells) {
    LightPtr& moving = std::next(scene.lights.begin(), 7)->second;
    auto moved = std::make_shared<Light>(*moving);
    moved->transform.translation += glm::dvec3(1.0, 0.0, 0.7) * cells * scene.grid.cell;
    moving = moved;
    ++scene.revision;
  };
  auto everywhere = reference::emittersOf(scene).triangles;
  move(2.0);
  for (const auto& e : reference::emittersOf(scene).triangles) everywhere.push_back(e);
  const auto points = reference::objectReceivers(scene.grid, everywhere, 600);
  std::vector<glm::dvec3> errors;
  double worst = 0.0;
  for (int step = 0; step <= kSteps; ++step, move(-2.0 / kSteps)) {
    const auto truth = reference::irradiances(reference::emittersOf(scene).triangles, points);
    const VolumePtr volume = volumeOf(scene);
    ASSERT_EQ(volume->layers.front().group, "direction 1");
    const auto seen = lookedUp(*volume, points);
    double largest = 0.0, jump = 0.0;
    std::vector<glm::dvec3> now;
    for (std::size_t i = 0; i < points.size(); ++i) {
      now.push_back(seen[i] - truth[i]);
      largest = std::max(largest, truth[i].x);
      if (step > 0) jump = std::max(jump, std::abs(now[i].x - errors[i].x));
    }
    EXPECT_LE(jump, 0.005 * largest) << step;
    worst = std::max(worst, jump / largest);
    errors = now;
  }
  RecordProperty("worst", std::to_string(worst));
}

/// Two spheres of .2 m, `by` metres on both sides of a place.
Scene partedBy(const glm::dvec3& place, double by) {
  Scene scene = sceneWith({place + glm::dvec3(0.0, 0.0, by), place - glm::dvec3(0.0, 0.0, by)});
  scene.grid = {glm::dvec3(-2.0), 0.125, glm::ivec3(32)};
  for (auto& [name, light] : scene.lights) {
    auto smaller = std::make_shared<Light>(*light);
    smaller->transform.scale = glm::dvec3(0.2);
    light = smaller;
  }
  return scene;
}

Scene withAGroupEach(Scene scene) {
  for (auto& [name, light] : scene.lights) {
    auto named = std::make_shared<Light>(*light);
    named->group = name;
    light = named;
  }
  return scene;
}

// Two lights part until each has a group: beside what changes with a group each all the time, none of 1,000 points
// changes from step to step, a twelfth of a cell, by more than .5 % of the largest. Groups that changed at once did it
// by 3.2 and .8 %. Broken by that; light that moves over in one tick; groups that give way only where they are off by
// the goal.
TEST_F(GroupingEngineTest, ARegroupingDoesNotJump) {
  SessionKey session = 1;
  for (const glm::dvec3& place : {glm::dvec3(-1.2, 1.2, 0.0), glm::dvec3(0.0, 1.5, 0.0)}) {
    session += 2;
    double worst = 0.0;
    std::uint64_t revision = 0;
    std::size_t layers = 1;
    VolumePtr before, apartBefore;
    for (double by = 0.0; by < 0.125; by += 0.01) {
      Scene scene = partedBy(place, by);
      scene.revision = ++revision;
      const VolumePtr volume = volumeOf(scene, session), apart = volumeOf(withAGroupEach(scene), session + 1);
      EXPECT_GE(volume->layers.size(), layers);
      layers = volume->layers.size();
      if (before != nullptr) {
        auto emitters = reference::emittersOf(scene).triangles;
        for (const auto& e : reference::emittersOf(partedBy(place, by - 0.01)).triangles) emitters.push_back(e);
        const auto points = reference::objectReceivers(scene.grid, emitters, 1000);
        const auto seen = lookedUp(*volume, points), seenApart = lookedUp(*apart, points);
        const auto was = lookedUp(*before, points), wasApart = lookedUp(*apartBefore, points);
        double largest = 0.0, jump = 0.0;
        for (std::size_t i = 0; i < points.size(); ++i) {
          largest = std::max(largest, seenApart[i].x);
          jump = std::max(jump, std::abs(seen[i].x - seenApart[i].x - was[i].x + wasApart[i].x));
        }
        worst = std::max(worst, jump / largest);
      }
      before = volume;
      apartBefore = apart;
    }
    EXPECT_EQ(layers, 2U);
    EXPECT_LE(worst, 0.005);
    RecordProperty(place.x < 0.0 ? "corner" : "middle", std::to_string(worst));
  }
}

// Broken by: light that never moves over, or not back.
TEST(Grouping, LightMovesOverAndBack) {
  Grouping grouping;
  const auto at = [&grouping](double by) {
    const Scene scene = partedBy({0.0, 1.5, 0.0}, by);
    std::vector<EmittingLight> lights = emittingLights(scene, scene.grid, {});
    groupLights(scene, cellsOf(scene), lights, grouping);
    grouping = {groupsOf(lights)};
    grouping.moved = lights[0].moved;
    if (grouping.moved > 0.0) grouping.next = {lights[0].nextGroup, lights[1].nextGroup};
  };
  std::vector<double> moved;
  for (double by = 0.0; grouping.groups != std::vector<int>{0, 1}; by += 0.004) {
    ASSERT_LT(by, 1.0);
    at(by);
    moved.push_back(grouping.moved);
    if (grouping.moved < 0.4) continue;
    while (grouping.moved > 0.0 && by > 0.0) at(by -= 0.004);
    EXPECT_EQ(grouping.groups, (std::vector<int>{0, 0})) << "back again";
    EXPECT_TRUE(grouping.next.empty());
    break;
  }
  EXPECT_GE(moved.size(), 3U);
  for (std::size_t i = 1; i < moved.size(); ++i) EXPECT_LE(moved[i] - moved[i - 1], 0.35);
  for (double by = 0.0; by < 0.2; by += 0.004) at(by);
  EXPECT_EQ(grouping.groups, (std::vector<int>{0, 1}));
  EXPECT_TRUE(grouping.next.empty());
}

// Broken by: an order that depends on addresses.
TEST_F(GroupingEngineTest, TheSameLightsGiveTheSameBytes) {
  const VolumePtr one = volumeOf(ceilingOf(20, 32), 1), other = volumeOf(ceilingOf(20, 32), 2);
  ASSERT_EQ(one->layers.size(), 8U);
  for (std::size_t i = 0; i < 8; ++i) {
    EXPECT_EQ(one->layers[i].group, other->layers[i].group);
    EXPECT_EQ(one->layers[i].coefficients, other->layers[i].coefficients);
  }
}

}  // namespace
}  // namespace lpv
