#include <cstdlib>

#include "gpu/support/gl_test.h"

namespace lpv {
namespace {

class LoopGuardTest : public test::GlTest {
 protected:
  void SetUp() override {
    test::GlTest::SetUp();
    const char* const value = std::getenv("LPV_LOOP_GUARD");
    if (value == nullptr || std::string(value) != "1") GTEST_SKIP() << "LPV_LOOP_GUARD=1 is not in the environment";
  }

  /// Threads whose loops were ended, of one group of 64, in which thread 5 goes `most` rounds and the others ten.
  static std::uint32_t endedOf(int most, std::uint32_t& rounds) {
    gpu::Program program = gpu::Program::computeOfText(
        "loops",
        "#include \"layout.h\"\nlayout(local_size_x = 64) in;\n"
        "layout(std430, binding = kTestIn) readonly buffer In { uint most[]; };\n"
        "layout(std430, binding = kTestOut) writeonly buffer Out { uint rounds[]; };\n"
        "void main() {\n  const uint own = gl_GlobalInvocationID.x == 5u ? most[0] : 10u;\n  uint i = 0u;\n"
        "  for (uint state = 1u; i < own && state != 0u; ++i) state = state * 1664525u + 1013904223u | 1u;\n"
        "  rounds[gl_GlobalInvocationID.x] = i;\n}\n",
        {});
    const gpu::Buffer in = test::bufferOf(std::vector<std::uint32_t>{std::uint32_t(most)});
    const gpu::Buffer out("out", 64 * sizeof(std::uint32_t));
    in.bindStorage(layout::kTestIn);
    out.bindStorage(layout::kTestOut);
    program.dispatch(1);
    gpu::memoryBarrier();
    rounds = test::read<std::uint32_t>(out)[5];
    return program.loopsEnded();
  }
};

TEST_F(LoopGuardTest, CountsNothingWhereLoopsEndByThemselves) {
  std::uint32_t rounds = 0;
  EXPECT_EQ(endedOf(60000, rounds), 0U);
  EXPECT_EQ(rounds, 60000U);
}

// On a driver that does not end loops, nothing is counted, and all rounds are done.
TEST_F(LoopGuardTest, CountsThreadsWhoseLoopsTheDriverEnds) {
  std::uint32_t rounds = 0;
  const std::uint32_t ended = endedOf(200000, rounds);
  EXPECT_EQ(ended == 0, rounds == 200000U) << ended << " " << rounds;
}

}  // namespace
}  // namespace lpv
