// transport/emitter_list.glsl = EmitterList of scene/emitter_list.h.

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "gpu/buffer_texture.h"
#include "gpu/support/gl_test.h"
#include "reference/direct_texels.h"
#include "scene/emitter_list.h"

namespace lpv {
namespace {

using reference::DirectLight;
using reference::randomPolygons;
using reference::randomTree;

constexpr double kSize = 8.0;

/// In and around the lights' cube, each with a normal.
std::vector<glm::vec4> positionsAndNormals() {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  std::vector<glm::vec4> out;
  for (int i = 0; i < 1000; ++i) {
    const float x = normal(random), y = normal(random), z = normal(random);
    out.emplace_back(float(0.5 * kSize) * (1.0F + glm::vec3(x, y, z)), 0.0F);
    const float nx = normal(random), ny = normal(random);
    out.emplace_back(glm::normalize(glm::vec3(nx, ny, normal(random))), 0.0F);
  }
  return out;
}

class DirectTest : public test::GlTest {
 protected:
  /// Largest difference between the two languages as a share of the largest irradiance.
  static double difference(const std::vector<DirectLight>& lights, double k) {
    EmitterList direct;
    direct.grid = {glm::dvec3(0.0), 1.0, glm::ivec3(int(kSize))};
    direct.always = true;
    direct.texels = reference::directTexels(lights, k);
    const gpu::Buffer buffer = test::bufferOf(direct.texels);
    const gpu::BufferTexture view("direct lights", buffer);
    view.bind(layout::kDirect);
    const std::vector<glm::vec4> points = positionsAndNormals();
    const auto out = test::evaluate(
        "#include \"common/sh.glsl\"\n#include \"transport/emitter_list.glsl\"",
        "if (i % 2u == 0u) outputs[i] = vec4(directIrradiance(inputs[i].xyz, inputs[i + 1u].xyz), 0);", points);
    double apart = 0.0, largest = 0.0;
    for (std::size_t i = 0; i < points.size(); i += 2) {
      const glm::dvec3 want = direct.irradiance(glm::dvec3(points[i]), glm::dvec3(points[i + 1]));
      for (int c = 0; c < 3; ++c) {
        const double d = std::abs(double(out[i][c]) - want[c]);
        apart = std::max(apart, std::isfinite(d) ? d : std::numeric_limits<double>::infinity());
        largest = std::max(largest, want[c]);
      }
    }
    return apart / largest;
  }

  static void compare(const std::string& name, const std::vector<DirectLight>& lights, double tolerance) {
    for (const double k : {0.0, 1.5, 4.0, 1e15}) EXPECT_LE(difference(lights, k), tolerance) << name << ", k " << k;
  }
};

// Broken by: no edge along the horizon; one side for two.
TEST_F(DirectTest, PolygonsAreTheSameInGlslAndCpp) {
  compare("one", {randomPolygons(1, false, kSize, 11)}, 1e-5);
  compare("several", {randomPolygons(32, false, kSize, 1)}, 1e-5);
  compare("both sides", {randomPolygons(32, true, kSize, 2)}, 1e-5);
}

// Broken by: 1 / r^2 cut at a cell; no light all around; k for k^2; no colours.
TEST_F(DirectTest, TreesAreTheSameInGlslAndCpp) {
  compare("tree", {randomTree(false, false, kSize, 3)}, 1e-5);
  compare("both sides", {randomTree(false, true, kSize, 4)}, 1e-5);
  compare("colours", {randomTree(true, false, kSize, 5)}, 1e-5);
  compare("colours, both sides", {randomTree(true, true, kSize, 6)}, 1e-5);
}

// Broken by: one light for all.
TEST_F(DirectTest, SeveralLightsAreTheSameInGlslAndCpp) {
  compare("all of them",
          {randomTree(true, true, kSize, 6), randomPolygons(5, false, kSize, 1), randomTree(false, false, kSize, 3),
           randomPolygons(2, true, kSize, 2)},
          1e-5);
}

/// Irradiance with normal z of two-sided triangles, by three corners; each in the place of its first corner.
std::vector<glm::vec4> fromTriangles(const std::vector<glm::vec4>& corners) {
  const gpu::Buffer buffer = test::bufferOf(std::vector<glm::vec4>(1));
  const gpu::BufferTexture view("direct lights", buffer);
  view.bind(layout::kDirect);
  return test::evaluate("#include \"common/sh.glsl\"\n#include \"transport/emitter_list.glsl\"",
                        "if (i % 3u == 0u) outputs[i].x = triangleIrradiance(inputs[i].xyz, "
                        "inputs[i + 1u].xyz, inputs[i + 2u].xyz, vec3(0, 0, 1), 2.0);",
                        corners);
}

// Corners on the horizon, and corners a million times as far away as others.
// Broken by: p + (q - p) t where an edge crosses the horizon.
TEST_F(DirectTest, AnyCornersAreTheSameInGlslAndCpp) {
  std::vector<glm::vec4> inputs;
  std::vector<double> want;
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  const glm::vec3 n(0, 0, 1);
  for (int i = 0; i < 2000; ++i) {
    glm::vec3 c[3];
    for (int k = 0; k < 3; ++k) {
      const float x = normal(random), y = normal(random);
      c[k] = {x, y, (i % 8) >> k & 1 ? 0.0F : normal(random)};
      if (i % 16 > 7) c[k] *= k == 0 ? 1e-3F : k == 1 ? 1.0F : 1e3F;
      inputs.emplace_back(c[k], 0.0F);
    }
    const glm::dvec3 corners[3] = {glm::dvec3(c[0]), glm::dvec3(c[1]), glm::dvec3(c[2])};
    want.push_back(triangleIrradiance(corners, glm::dvec3(n), 2));
  }
  const auto out = fromTriangles(inputs);
  for (std::size_t i = 0; i < want.size(); ++i) ASSERT_NEAR(out[3 * i].x, want[i], 2e-5) << i % 8;
}

// A lamp of .2 m lights a floor of 200 m: at 500 times its size its edges all but cancel.
// Broken by: the product of the corners for that of corner and edge (60 % off).
TEST_F(DirectTest, ASmallPolygonFarAwayIsNotLostInRounding) {
  std::vector<glm::vec4> inputs;
  std::vector<double> want;
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  for (int i = 0; i < 500; ++i) {
    const float x = normal(random), y = normal(random);
    const glm::vec3 at = 16.0F * glm::normalize(glm::vec3(x, y, 2.0F));
    for (int k = 0; k < 3; ++k) {
      const float u = normal(random), v = normal(random);
      inputs.emplace_back(at + 0.03F * glm::vec3(u, v, normal(random)), 0.0F);
    }
    glm::dvec3 corners[3];
    for (int k = 0; k < 3; ++k) corners[k] = glm::dvec3(inputs[inputs.size() - 3 + std::size_t(k)]);
    want.push_back(triangleIrradiance(corners, glm::dvec3(0.0, 0.0, 1.0), 2));
  }
  const auto out = fromTriangles(inputs);
  const double largest = *std::max_element(want.begin(), want.end());
  for (std::size_t i = 0; i < want.size(); ++i) EXPECT_NEAR(out[3 * i].x, want[i], 1e-3 * largest) << i;
}

}  // namespace
}  // namespace lpv
