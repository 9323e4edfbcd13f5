// Sums of the light of many that are kept: the same bytes as without, for less work.
#include "lpv/transport/light_sums.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>

#include "gpu/transport/gather_rig.h"
#include "gpu/usage.h"
#include "reference/meshes.h"

namespace lpv {
namespace {

const Grid kHall{{0.0, 0.0, 0.0}, 0.5, {16, 8, 12}};
constexpr std::size_t kLights = 27;  // in fours, the last of them three

EmittingLight lightAt(std::size_t i, double moved = 0.0) {
  const double t = double(i);
  const glm::dvec3 place(1.0 + 14.0 * glm::fract(0.618 * t) + moved, 1.0 + 6.0 * glm::fract(0.755 * t),
                         1.0 + 10.0 * glm::fract(0.57 * t));
  const glm::dvec3 radiance = i % 3 == 0 ? glm::dvec3(1.0, 0.2, 0.1) : glm::dvec3(0.3 + 0.1 * t);
  EmittingLight out = test::placed(i % 2 == 0 ? reference::quad() : reference::pyramid(),
                                   test::poseOf(place, glm::dvec3(0.7)), radiance, i % 5 == 0);
  out.group = int(i % 3);
  return out;
}

std::vector<EmittingLight> manyLights() {
  std::vector<EmittingLight> all;
  for (std::size_t i = 0; i < kLights; ++i) all.push_back(lightAt(i));
  return all;
}

struct Gathered {
  std::vector<std::uint32_t> field, distances;
  std::uint64_t dispatches = 0;

  bool sameBytes(const Gathered& other) const { return field == other.field && distances == other.distances; }
};

/// All cells, with what `sums` kept, and has begun, or nothing.
Gathered gatherWith(test::GatherRig& rig, LightSums& sums) {
  rig.clear();
  rig.field->emitterDistance.fill(std::bit_cast<std::uint32_t>(layout::kFarFromVpls));
  std::swap(rig.sums, sums);
  Gathered out;
  const std::uint64_t before = gpu::usage().dispatches;
  rig.gatherBlocks(2.0, allBlocks(kHall.dims));
  out.dispatches = gpu::usage().dispatches - before;
  std::swap(rig.sums, sums);
  out.field = rig.bits();
  out.distances = test::read<std::uint32_t>(rig.field->emitterDistance);
  return out;
}

/// A tick that keeps, with these blockers.
Gathered tick(test::GatherRig& rig, LightSums& sums, Stamp blockers = 0) {
  sums.begin({1, 2.0, rig.sectors, 0, blockers, allBlocks(kHall.dims)},
             sentInputs(rig.lights, rig.voxels, rig.palette));
  Gathered out = gatherWith(rig, sums);
  sums.end();
  return out;
}

Gathered anew(test::GatherRig& rig) {
  LightSums none;
  return gatherWith(rig, none);
}

class LightSumsTest : public test::GatherTest, public testing::WithParamInterface<Sectors> {
 protected:
  test::GatherRig& planted() {
    rig().sectors = GetParam();
    return GatherTest::planted(kHall, manyLights());
  }
  void TearDown() override {
    if (!IsSkipped()) rig().sectors = Sectors::kNone;
  }
};

// Broken by: sums kept whose light has moved since; a half that is added to what holds something; layers left out.
TEST_P(LightSumsTest, HaveTheBytesOfSummingAnew) {
  test::GatherRig& r = planted();
  LightSums sums;
  EXPECT_TRUE(tick(r, sums).sameBytes(anew(r)));
  struct Step {
    std::size_t light;
    double moved;
  };
  std::vector<EmittingLight> lights = r.lights;
  for (const Step& step : {Step{9, 0.5}, {9, 1.0}, {9, 1.5}, {20, 0.5}, {9, 0.0}, {26, -0.5}, {20, 0.0}, {0, 0.3}}) {
    lights[step.light] = lightAt(step.light, step.moved);
    GatherTest::planted(kHall, lights);
    const Gathered got = tick(r, sums);
    EXPECT_TRUE(got.sameBytes(anew(r))) << "light " << step.light << " moved by " << step.moved;
  }
  lights[4].radiance = glm::dvec3(0.9);
  GatherTest::planted(kHall, lights);
  EXPECT_TRUE(tick(r, sums).sameBytes(anew(r))) << "another radiance";
  lights.pop_back();
  GatherTest::planted(kHall, lights);
  EXPECT_TRUE(tick(r, sums).sameBytes(anew(r))) << "a light less";
}

// Broken by: nothing kept; all of it let go of in each tick.
TEST_P(LightSumsTest, SpareTheLightsThatStandStill) {
  test::GatherRig& r = planted();
  LightSums sums;
  const std::uint64_t all = tick(r, sums).dispatches;
  EXPECT_GE(all, kLights);
  std::vector<EmittingLight> lights = r.lights;
  std::uint64_t step = all;
  for (int i = 1; i <= 3; ++i) {
    lights[9] = lightAt(9, 0.2 * i);
    GatherTest::planted(kHall, lights);
    step = tick(r, sums).dispatches;
  }
  EXPECT_LE(step, 4U + 4U) << "four lights, and a sum for each time that 27 are halved";
  EXPECT_GE(tick(r, sums, 1).dispatches, kLights) << "something else is in the way";
}

INSTANTIATE_TEST_SUITE_P(Layers, LightSumsTest, testing::Values(Sectors::kNone, Sectors::kAroundY));

// Broken by: more sums than memory allows; a light in no range, or in two.
TEST(LightRanges, HalveAllLightsAsMemoryAllows) {
  for (const std::size_t bytes : {std::size_t(1) << 20U, std::size_t(37) << 20U, std::size_t(110) << 20U}) {
    for (const std::size_t lights : {1, 4, 5, 27, 64, 1000}) {
      const std::size_t atOnce = lightsAtOnce(lights, bytes);
      std::size_t next = 0, deepest = 0;
      const auto walk = [&](const auto& self, const LightRange& range, std::size_t depth) -> void {
        deepest = std::max(deepest, depth);
        if (range.count() <= atOnce) {
          EXPECT_EQ(range.begin, next);
          next = range.end;
          return;
        }
        for (const LightRange& half : halvesOf(range, atOnce)) self(self, half, depth + 1);
      };
      walk(walk, {0, lights}, 0);
      EXPECT_EQ(next, lights);
      EXPECT_LE(deepest * bytes, std::size_t(128) << 20U) << lights;
      const bool roomForAll = bytes == std::size_t(1) << 20U;
      EXPECT_EQ(roomForAll, roomForAll && atOnce == 4) << lights;
    }
  }
}

}  // namespace
}  // namespace lpv
