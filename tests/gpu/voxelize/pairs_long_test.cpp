// 10^9 decisions about pairs, none of which may differ (MATHS.md 6.8): 245 s on two shared cores with llvmpipe, 4
// million a second, a quarter of them pairs. LPV_SHORT in the environment: 2 * 10^7 in a few seconds.

#include <chrono>
#include <cstdlib>

#include "gpu/voxelize/pair_families.h"

namespace lpv {
namespace {

class PairsLongTest : public test::GlTest {};

TEST_F(PairsLongTest, ABillionDecisions) {
  const std::uint64_t wanted = std::getenv("LPV_SHORT") != nullptr ? 20'000'000 : 1'000'000'000;
  test::PairRig rig;
  const auto start = std::chrono::steady_clock::now();
  const test::PairVerdict verdict =
      test::compareFamilies(rig, wanted, {{32, 32, 32}, {64, 64, 64}, {128, 20, 45}, {9, 128, 1}, {128, 128, 128}});
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  EXPECT_GE(verdict.decisions, wanted);
  RecordProperty("decisions", std::to_string(verdict.decisions));
  RecordProperty("pairs", std::to_string(verdict.pairs));
  RecordProperty("decisions_per_second", std::to_string(double(verdict.decisions) / seconds.count()));
}

}  // namespace
}  // namespace lpv
