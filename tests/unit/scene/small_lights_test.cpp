// Which lights receivers look at wherever they are.
#include "scene/small_lights.h"

#include <gmock/gmock.h>

#include <cmath>

#include "scene/emitter_tree.h"

namespace lpv {
namespace {

using ::testing::Each;
using ::testing::ElementsAre;

constexpr LightSize kLamp{2, true, 0.3}, kBulb{720, true, 0.1}, kPanel{2, true, 8.0};

std::vector<double> sharesOf(const std::vector<LightSize>& lights) { return lookedAtShares(lights); }
bool everywhere(const std::vector<LightSize>& lights) { return areLookedAtEverywhere(lookedAtShares(lights)); }

// Broken by: a light too many, or one that is not small.
TEST(SmallLights, OnlyFewAreLookedAtEverywhere) {
  EXPECT_TRUE(everywhere({kLamp}));
  EXPECT_TRUE(everywhere(std::vector<LightSize>(16, kLamp)));
  EXPECT_THAT(sharesOf(std::vector<LightSize>(17, kLamp)), Each(0.0));
  EXPECT_TRUE(everywhere({kBulb, kBulb}));
  EXPECT_FALSE(everywhere({kBulb, kBulb, kBulb}));
  EXPECT_FALSE(everywhere({}));
}

// Broken by: all lights or none.
TEST(SmallLights, OthersAreLeftToTheGrid) {
  EXPECT_THAT(sharesOf({kPanel, kLamp, kBulb}), ElementsAre(0.0, 1.0, 1.0));
  EXPECT_THAT(sharesOf({kLamp, {2, false, 0.3}, {kMostTreeTriangles + 1, true, 0.3}}), ElementsAre(1.0, 0.0, 0.0));
}

// The smallest first, whatever their names. Broken by: the order of names.
TEST(SmallLights, TheSmallestAreLookedAt) {
  std::vector<LightSize> lights(40, LightSize{2, true, 0.9});
  lights[30].cellsAcross = 0.01;
  lights[35].cellsAcross = 0.02;
  const std::vector<double> shares = sharesOf(lights);
  for (std::size_t i = 0; i < lights.size(); ++i) EXPECT_EQ(shares[i], i == 30 || i == 35 ? 1.0 : 0.0) << i;
}

// Lights of three costs that grow through one another, beside others: whoever is looked at, a growth of .002 cells
// changes no share by more than .03 of it. Broken by: a light that costs too much passed over for the next; a limit
// without a width.
TEST(SmallLights, SharesAreContinuousInAllSizes) {
  std::vector<double> before;
  for (double size = 0.2; size < 2.0; size += 0.002) {
    std::vector<LightSize> lights(12, LightSize{2, true, 0.8});
    lights.push_back({2, true, size});
    lights.push_back({720, true, 0.5 * size + 0.3});
    lights.push_back({6, true, 1.6 - 0.5 * size});
    for (int i = 0; i < 4; ++i) lights.push_back({2, true, 1.1 + 0.05 * i});
    const std::vector<double> now = sharesOf(lights);
    std::size_t looked = 0;
    for (std::size_t i = 0; i < now.size(); ++i) {
      if (now[i] > 0.0) looked += lights[i].triangles > 32 ? kPolygonsOfTree : lights[i].triangles;
      if (before.empty()) continue;
      EXPECT_NEAR(now[i], before[i], 0.03) << "light " << i << " at " << size;
    }
    EXPECT_LE(looked, kMostLookedAt);
    before = now;
  }
}

// Broken by: cells without an end; halves of what is asked for.
TEST(SmallLights, CellsOfVoxelsFollowTheSize) {
  EXPECT_EQ(voxelEdge(20.0), 1.0);
  EXPECT_EQ(voxelEdge(4.0), 1.0);
  EXPECT_EQ(voxelEdge(3.9), 0.5);
  EXPECT_EQ(voxelEdge(0.3), 0.0625);
  EXPECT_EQ(voxelEdge(1e-9), std::ldexp(1.0, -kMostHalvings));
}

}  // namespace
}  // namespace lpv
