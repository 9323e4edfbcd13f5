// SH of GLSL = C++ = reference, and the constants of the stencil.

#include "scene/sh.h"

#include <random>

#include "gpu/support/gl_test.h"
#include "reference/propagate.h"
#include "reference/sh.h"

namespace lpv {
namespace {

class ShTest : public test::GlTest {};

std::vector<glm::vec4> directions(int count) {
  std::mt19937 random(1);
  std::normal_distribution<double> normal;
  std::vector<glm::vec4> out;
  for (int i = 0; i < count; ++i)
    out.emplace_back(glm::normalize(glm::dvec3(normal(random), normal(random), normal(random))), 0.0);
  return out;
}

void expectNear(const glm::vec4& a, const glm::dvec4& b) {
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(a[k], b[k], 2e-7);
}

// Broken by: exchanging two components of shBasis; a Condon-Shortley sign; 0.4886 for kY1.
TEST_F(ShTest, BasisAndLobeAreTheSameInGlslCppAndReference) {
  const std::vector<glm::vec4> w = directions(200);
  const auto basis = test::evaluate("#include \"common/sh.glsl\"", "outputs[i] = shBasis(inputs[i].xyz);", w);
  const auto lobe = test::evaluate("#include \"common/sh.glsl\"", "outputs[i] = shLobe(inputs[i].xyz);", w);
  for (std::size_t i = 0; i < w.size(); ++i) {
    const glm::dvec3 d(w[i]);
    expectNear(basis[i], sh::basis(d));
    expectNear(basis[i], reference::basis(d));
    expectNear(lobe[i], sh::lobe(d));
    expectNear(lobe[i], reference::lobe(d));
  }
}

// Broken by: kFarAngle 0.4; the side-angle digit slip 0.4234413544 fails the last digit of kB.
TEST_F(ShTest, StencilConstantsAreTheReferences) {
  const auto c = test::evaluate(
      "#include \"common/sh.glsl\"\n#include \"transport/stencil.glsl\"",
      "outputs[0] = vec4(kA00, kA01, kA10, kA11); outputs[1] = vec4(kB, kFarAngle, kSideAngle, 0);", {glm::vec4(0)}, 2);
  const reference::Stencil s = reference::stencil();
  const reference::FaceSolidAngles angles = reference::faceSolidAngles();
  const std::vector<double> want = {s.a00, s.a01, s.a10, s.a11, s.b, angles.front, angles.side};
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(c[i / 4][int(i % 4)] / want[i], 1.0, 3e-7) << i;
}

}  // namespace
}  // namespace lpv
