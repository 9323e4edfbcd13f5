// transport/vpl_kernel.glsl: the one kernel, for a column of cells, for a point, in C++, and as the reference derives
 // it.

#include <cmath>
#include <random>

#include "gpu/support/gl_test.h"
#include "reference/gather.h"
#include "scene/emitter_list.h"

namespace lpv {
namespace {

constexpr int kVpls = 4000, kInputs = 6;  // per VPL: four texels, the receiver, a normal

struct KernelCase {
  reference::Vpl vpl;
  glm::dvec3 receiver{0.0}, normal{0.0};
};

glm::vec3 randomVector(std::mt19937& random, float scale) {
  std::normal_distribution<float> normal(0.0F, scale);
  const float x = normal(random), y = normal(random);
  return {x, y, normal(random)};
}

/// In and around a VPL of any extent, flat, or merged of directions that cancel. Numbers that floats hold.
class KernelCases {
 public:
  KernelCases() {
    std::mt19937 random(41);
    for (int i = 0; i < kVpls; ++i) add(random, i);
  }

  std::vector<glm::vec4> inputs;
  std::vector<KernelCase> cases;

 private:
  void add(std::mt19937& random, int i) {
    std::uniform_real_distribution<float> share(0.0F, 1.0F);
    reference::Vpl vpl;
    const float area = std::exp(4.0F * share(random) - 2.0F);
    const float aligned = i % 4 == 0 ? 0.0F : i % 4 == 1 ? 0.999F : share(random);
    const glm::vec3 direction = area * aligned * glm::normalize(randomVector(random, 1.0F));
    const glm::vec3 position = randomVector(random, 3.0F), a = randomVector(random, share(random)),
                    b = randomVector(random, share(random));
    const glm::mat3 covariance = glm::outerProduct(a, a) + glm::outerProduct(b, b);
    vpl.area = vpl.weight = double(area);
    vpl.areaNormal = glm::dvec3(direction);
    vpl.weightedPosition = vpl.weight * glm::dvec3(position);
    vpl.weightedSquare =
        vpl.weight * (glm::dmat3(covariance) + glm::outerProduct(glm::dvec3(position), glm::dvec3(position)));
    const glm::vec3 receiver = position + randomVector(random, i % 3 == 0 ? 0.4F : 4.0F);
    const glm::vec3 normal = glm::normalize(randomVector(random, 1.0F));
    const float trace = covariance[0][0] + covariance[1][1] + covariance[2][2];
    inputs.insert(inputs.end(), {glm::vec4(position, area), glm::vec4(direction, float(reference::spreadOf(vpl))),
                                 glm::vec4(covariance[0][0], covariance[1][1], covariance[2][2], trace),
                                 glm::vec4(covariance[0][1], covariance[0][2], covariance[1][2], 2.0F),
                                 glm::vec4(receiver, 0.0F), glm::vec4(normal, 0.0F)});
    cases.push_back({vpl, glm::dvec3(receiver), glm::dvec3(normal)});
  }
};

/// Fluence, D and E of every case by the shader. `receivers` 4: of the last of four, no E.
std::vector<glm::vec4> evaluated(const KernelCases& cases, int receivers, bool twoSided) {
  const std::string dz = receivers == 1 ? "d.z" : "d.z + vec4(3, 2, 1, 0)", lane = receivers == 1 ? "" : ".w";
  const std::string sides = twoSided ? "true" : "false";
  return test::evaluate(
      "#include \"transport/vpl_kernel.glsl\"",
      "if (i % 6u != 0u) return;\n"
      "const VplEntry v = vplEntry(inputs[i], inputs[i + 1u], inputs[i + 2u], inputs[i + 3u]);\n"
      "const vec3 d = v.position - inputs[i + 4u].xyz;\n"
      "const Arriving light = arrivingFrom(v, d.x, d.y, " +
          dz + ", " + sides +
          ");\n"
          "outputs[i / 3u] = vec4(light.x" +
          lane + ", light.y" + lane + ", light.z" + lane + ", light.fluence" + lane + ");\n" +
          (receivers == 1 ? "outputs[i / 3u + 1u] = vec4(irradianceFrom(v, d, inputs[i + 5u].xyz, " + sides + "));"
                          : ""),
      cases.inputs, 2 * cases.cases.size(), {{"LPV_RECEIVERS", std::to_string(receivers)}});
}

/// E of every case by the shader for four receivers anywhere: the last of four, the others displaced and turned.
std::vector<glm::vec4> evaluatedAmongFour(const KernelCases& cases, bool twoSided) {
  const std::string sides = twoSided ? "true" : "false";
  return test::evaluate(
      "#include \"transport/vpl_kernel.glsl\"",
      "if (i % 6u != 0u) return;\n"
      "const VplEntry v = vplEntry(inputs[i], inputs[i + 1u], inputs[i + 2u], inputs[i + 3u]);\n"
      "const vec3 d = v.position - inputs[i + 4u].xyz, n = inputs[i + 5u].xyz;\n"
      "const vec4 e = irradianceFrom(v, d.x + vec4(1, 0, 0, 0), d.y + vec4(0, 2, 0, 0), d.z + vec4(0, 0, 3, 0),\n"
      "  vec4(n.y, n.z, n.y, n.x), vec4(n.z, n.x, n.x, n.y), vec4(n.x, n.y, n.z, n.z), " +
          sides +
          ");\n"
          "outputs[i / 6u] = e.wwww;\n",
      cases.inputs, cases.cases.size(), {{"LPV_RECEIVERS", "4"}, {"LPV_RECEIVERS_APART", "1"}});
}

/// Both sides of a VPL are two VPLs.
reference::VplMoments expected(const KernelCase& c, bool twoSided) {
  reference::VplMoments moments = reference::momentsOf(c.vpl, c.receiver, 1.0);
  if (!twoSided) return moments;
  reference::Vpl back = c.vpl;
  back.areaNormal = -back.areaNormal;
  const reference::VplMoments more = reference::momentsOf(back, c.receiver, 1.0);
  return {moments.fluence + more.fluence, moments.vectorIrradiance + more.vectorIrradiance};
}

/// Largest light that the case's parts can be: what rounding is measured by.
double scaleOf(const KernelCase& c) {
  const double r = std::max(0.5, glm::length(c.vpl.position() - c.receiver));
  const glm::dmat3 v = c.vpl.extent();
  return c.vpl.area / (r * r) * (1.0 + (v[0][0] + v[1][1] + v[2][2]) / (r * r));
}

class VplKernelTest : public test::GlTest {};

// Broken by: 2.0 for kRegularisation; variances.z for covariances.z in V d; one side for both; -7.5 for 7.5; for four
// anywhere: ny for nz in the variance of heights, the first one's normal for all.
TEST_F(VplKernelTest, IsTheReferencesForColumnsPointsAndInCpp) {
  const KernelCases cases;
  for (const bool twoSided : {false, true}) {
    const std::vector<glm::vec4> column = evaluated(cases, 4, twoSided), point = evaluated(cases, 1, twoSided);
    const std::vector<glm::vec4> four = evaluatedAmongFour(cases, twoSided);
    double inColumn = 0.0, atPoint = 0.0, inCpp = 0.0, illuminated = 0.0, amongFour = 0.0;
    for (std::size_t i = 0; i < cases.cases.size(); ++i) {
      const KernelCase& c = cases.cases[i];
      const Arriving cpp = lightFromVpl(&cases.inputs[i * kInputs], c.receiver, twoSided ? 2 : 1);
      const reference::VplMoments want = expected(c, twoSided);
      const double scale = scaleOf(c);
      const auto off = [&](const glm::dvec4& got) {
        const glm::dvec4 apart = glm::abs(got - glm::dvec4(want.vectorIrradiance, want.fluence)) / scale;
        return std::max({apart.x, apart.y, apart.z, apart.w});
      };
      inColumn = std::max(inColumn, off(glm::dvec4(column[2 * i])));
      atPoint = std::max(atPoint, off(glm::dvec4(point[2 * i])));
      inCpp = std::max(inCpp, off(glm::dvec4(cpp.vectorIrradiance, cpp.fluence)));
      const double e = reference::irradianceOf(want.vectorIrradiance, c.vpl, c.receiver, c.normal, 1.0);
      illuminated = std::max(illuminated, std::abs(double(point[2 * i + 1].x) - e) / scale);
      amongFour = std::max(amongFour, std::abs(double(four[i].x) - e) / scale);
    }
    EXPECT_LE(inColumn, 1e-5) << twoSided;
    EXPECT_LE(atPoint, 1e-5) << twoSided;
    EXPECT_LE(inCpp, 1e-5) << twoSided;
    EXPECT_LE(illuminated, 1e-4) << twoSided;
    EXPECT_LE(amongFour, 1e-4) << twoSided;
  }
}

}  // namespace
}  // namespace lpv
