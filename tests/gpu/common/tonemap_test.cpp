#include "scene/tonemap.h"

#include <cmath>

#include "gpu/support/gl_test.h"

namespace lpv {
namespace {

class TonemapTest : public test::GlTest {};

std::vector<glm::vec4> ramp() {
  std::vector<glm::vec4> out = {glm::vec4(0.0F), glm::vec4(1e30F), glm::vec4(65504.0F)};
  for (double x = 1e-7; x < 1e4; x *= 1.07) out.emplace_back(x, 0.5 * x, 3.0 * x, 0.0);
  return out;
}

// Broken by: 2.4 for the 2.51 of the curve; 2.2 for the 2.4 of sRGB. A display step is 1/255; half of one is allowed,
// llvmpipe's pow() alone takes a tenth.
TEST_F(TonemapTest, CurveIsTheSameInGlslAndCpp) {
  const std::vector<glm::vec4> in = ramp();
  const double ev = -1.5;
  const auto out = test::evaluate("#include \"common/tonemap.glsl\"",
                                  "outputs[i] = vec4(displayFromRadiance(inputs[i].rgb, exp2(-1.5)), 0.0);", in);
  for (std::size_t i = 0; i < in.size(); ++i) {
    for (int c = 0; c < 3; ++c) {
      const double want = srgbFromLinear(toneCurve(double(in[i][c]) * std::exp2(ev)));
      EXPECT_NEAR(out[i][c], want, 0.5 / 255.0) << "x = " << in[i][c];
    }
  }
}

}  // namespace
}  // namespace lpv
