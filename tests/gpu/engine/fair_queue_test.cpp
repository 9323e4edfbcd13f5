// Whose turn it is, and what is predicted: no GPU, no clock.

#include "lpv/device/fair_queue.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <vector>

#include "lpv/device/admission_cost.h"
#include "reference/meshes.h"

namespace lpv {
namespace {

constexpr FairQueue::Tenant kLarge = 1, kSmall = 2;

FairQueue::Tenant next(const FairQueue& turns, const std::vector<FairQueue::Tenant>& able) {
  const auto same = [](FairQueue::Tenant tenant) { return tenant; };
  return *leastServed(turns, able.begin(), able.end(), same);
}

/// Who had the turns while pieces of the large tenant take 10 ms and those of the small one 1 ms.
std::string turnsOf(FairQueue& turns, int count) {
  std::string out;
  for (int i = 0; i < count; ++i) {
    const FairQueue::Tenant tenant = next(turns, {kLarge, kSmall});
    turns.begin(tenant);
    turns.charge(tenant, tenant == kLarge ? 0.010 : 0.001);
    out += tenant == kLarge ? 'L' : 's';
  }
  return out;
}

// Equal time, not equal turns. Broken by: going round whatever pieces cost.
TEST(FairQueue, GoByTime) {
  FairQueue turns;
  turns.arrive(kLarge);
  turns.arrive(kSmall);
  EXPECT_THAT(turnsOf(turns, 23),
              testing::AnyOf("LssssssssssLssssssssssL", "LsssssssssssLsssssssssL", "LssssssssssLsssssssssss"));
}

// Ticks of five pieces beside a tenant that never stops: between two of them at most one of its pieces passes, and
// within one none. Broken by: arrive() leaving what was used before (the large tenant's or the small one's time is
// saved up); begin() that does not note the time.
TEST(FairQueue, WhoComesBackIsServedNext) {
  FairQueue turns;
  turns.arrive(kLarge);
  for (int i = 0; i < 1000; ++i) {  // alone for long
    turns.begin(kLarge);
    turns.charge(kLarge, 0.010);
  }
  for (int tick = 0; tick < 50; ++tick) {
    turns.begin(kLarge);  // a piece of its own, while the other rests
    turns.charge(kLarge, 0.010);
    turns.arrive(kSmall);
    EXPECT_EQ(turnsOf(turns, 5), "sssss") << tick;
  }
  // It has used less all the while, and yet has saved up no more than one piece of the other, which counts twice.
  turns.arrive(kSmall);
  EXPECT_NE(turnsOf(turns, 22).find('L'), std::string::npos);
}

/// Seconds that each tenant has had after `turns` of 10 ms, while their ticks take so long.
std::map<FairQueue::Tenant, double> shares(const std::map<FairQueue::Tenant, double>& tickSeconds) {
  FairQueue turns;
  std::map<FairQueue::Tenant, double> had, left;
  std::vector<FairQueue::Tenant> all;
  for (const auto& [tenant, seconds] : tickSeconds) all.push_back(tenant);
  for (int i = 0; i < 30'000; ++i) {
    for (const FairQueue::Tenant tenant : all) {
      if (left[tenant] > 0.0) continue;
      turns.arrive(tenant);
      left[tenant] = tickSeconds.at(tenant);
    }
    const FairQueue::Tenant tenant = next(turns, all);
    turns.begin(tenant);
    turns.charge(tenant, 0.010);
    left[tenant] -= 0.010;
    had[tenant] += 0.010;
  }
  return had;
}

// Broken by: charge() that counts all time alike; arrive() that does not begin a new tick.
TEST(FairQueue, ATickThatTakesLongLetsShortOnesPass) {
  const auto beside = shares({{kSmall, 0.04}, {kLarge, 30.0}});
  EXPECT_NEAR(beside.at(kSmall) / beside.at(kLarge), 2.0, 0.05);
}

// Broken by: charge() that counts a tick's time by its square.
TEST(FairQueue, TicksThatAllTakeLongHaveEqualTime) {
  const auto equals = shares({{1, 10.0}, {2, 30.0}, {3, 60.0}});
  EXPECT_NEAR(equals.at(1) / equals.at(3), 1.0, 0.05);
  EXPECT_NEAR(equals.at(2) / equals.at(3), 1.0, 0.05);
}

TEST(FairQueue, ACorrectionCounts) {
  FairQueue turns;
  turns.arrive(kLarge);
  turns.arrive(kSmall);
  turns.charge(kLarge, 0.005);
  turns.charge(kSmall, 0.004);
  EXPECT_EQ(next(turns, {kLarge, kSmall}), kSmall);
  turns.charge(kSmall, 0.003);  // it took longer than predicted
  EXPECT_EQ(next(turns, {kLarge, kSmall}), kLarge);
}

LightingSettings propagating(int iterations) {
  LightingSettings options = LightingSettings::paper();
  options.iterations = iterations;
  return options;
}

Workload workloadOf(const LightingSettings& options, int edge, double scale = 1.0, int lights = 1) {
  const Grid grid{glm::dvec3(0.0), 4.0 / edge, glm::ivec3(edge)};
  Workload out(options, grid);
  Light light;
  light.mesh = reference::sphere();
  light.transform.scale = glm::dvec3(scale);
  for (int i = 0; i < lights; ++i) out.add(light);
  return out;
}

double secondsOf(const Workload& workload) { return predict(CostModel(), workload).seconds; }

// Broken by: leaving iterations, cells, lights, their size, groups or colours out of unitsOf().
TEST(Predict, DearerThingsCostMore) {
  const double base = secondsOf(workloadOf(propagating(32), 32));
  EXPECT_GT(secondsOf(workloadOf(propagating(64), 32)), 1.5 * base);
  EXPECT_GT(secondsOf(workloadOf(propagating(32), 64)), 6.0 * base);
  const double gather = secondsOf(workloadOf(LightingSettings(), 32));
  EXPECT_GT(secondsOf(workloadOf(LightingSettings(), 32, 2.0)), 1.2 * gather) << "larger lights";
  EXPECT_GT(secondsOf(workloadOf(LightingSettings(), 32, 1.0, 20)), 10.0 * gather);

  Workload grouped = workloadOf(propagating(32), 32);
  Light light;
  light.mesh = reference::quad();
  grouped.add(light);
  const double one = secondsOf(grouped);
  light.group = "other";
  grouped.add(light);
  EXPECT_GT(secondsOf(grouped), 1.5 * one);
  const double white = secondsOf(grouped);
  light.radiance = {1.0, 0.0, 0.0};
  grouped.add(light);
  EXPECT_GT(secondsOf(grouped), 1.3 * white);
  light.enabled = false;
  const double before = secondsOf(grouped);
  grouped.add(light);
  EXPECT_EQ(secondsOf(grouped), before) << "a light that is switched off costs nothing";
}

// Broken by: layers for a grouping that the scene names, or that another lookup has none of; one layer for many lights.
TEST(Predict, LayersThatTheServerMakesAreExpected) {
  const auto layersOf = [](const LightingSettings& options, int lights) {
    const Workload workload = workloadOf(options, 32, 1.0, lights);
    return std::pair(workload.groups(), workload.byDirection());
  };
  EXPECT_EQ(layersOf({}, 1), std::pair(1, false));
  EXPECT_EQ(layersOf({}, 3), std::pair(3, false));
  EXPECT_EQ(layersOf({}, 20), std::pair(8, true));
  EXPECT_EQ(layersOf(propagating(32), 20), std::pair(1, false));
  LightingSettings bands;
  bands.lookup = Lookup::kSh2;
  EXPECT_EQ(layersOf(bands, 20), std::pair(1, false));
  Workload named = workloadOf({}, 32, 1.0, 20);
  Light light;
  light.mesh = reference::quad();
  light.group = "key";
  named.add(light);
  EXPECT_EQ(named.groups(), 2);
  EXPECT_FALSE(named.byDirection());
}

// Broken by: counting area that lies outside of the grid.
TEST(Predict, AHugeLightCostsNoMoreThanTheGridHolds) {
  EXPECT_LT(secondsOf(workloadOf(LightingSettings(), 32, 1e6)), 30.0);
}

// Broken by: a model that does not learn, or believes one odd piece.
TEST(Predict, ADeviceIsMeasured) {
  CostModel costs;
  const double before = costs.secondsPerUnit(Stage::kPropagate);
  costs.learn(Stage::kPropagate, 0.005, 0.005 / (10.0 * before));
  EXPECT_LT(costs.secondsPerUnit(Stage::kPropagate), 2.0 * before) << "one piece";
  for (int i = 0; i < 1000; ++i) costs.learn(Stage::kPropagate, 0.005, 0.005 / (10.0 * before));
  EXPECT_NEAR(costs.secondsPerUnit(Stage::kPropagate), 10.0 * before, 0.1 * before);
  EXPECT_EQ(predict(costs, workloadOf(propagating(1000), 32)).mostly, Stage::kPropagate);
}

// Broken by: rates of pieces that are averaged by their seconds: half a second for a hundred units, a few times, and no
// session was admitted any more.
TEST(Predict, PiecesThatHaveToWaitDoNotMakeADeviceSlow) {
  CostModel costs;
  const double before = costs.secondsPerUnit(Stage::kVolume);
  for (int i = 0; i < 2; ++i) costs.learn(Stage::kVolume, 0.5, 100.0);
  EXPECT_LT(costs.secondsPerUnit(Stage::kVolume), 10.0 * before);
  for (int i = 0; i < 200; ++i) costs.learn(Stage::kVolume, 0.005, 0.005 / before);
  EXPECT_LT(costs.secondsPerUnit(Stage::kVolume), 1.2 * before);
}

}  // namespace
}  // namespace lpv
