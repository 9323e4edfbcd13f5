// Emission directions at vertices, in FLUX: the exact 2-band lobe of the direction of every point (MATHS.md 2; 6.1,
// 6.7, 6.9).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/compare.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/textures.h"
#include "scene/transform.h"
#include "unit/reference/fixtures.h"

namespace lpv::reference {
namespace {

/// A mesh with a direction at each vertex, from its position.
template <typename Direction>
MeshPtr directed(const MeshPtr& mesh, Direction direction) {
  Mesh out = *mesh;
  for (const glm::vec3& p : mesh->positions) out.directions.emplace_back(direction(p));
  return std::make_shared<const Mesh>(out);
}

/// One triangle with a right angle, legs of 1 m in z = 0, and these directions.
MeshPtr triangleWith(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
  Mesh mesh;
  mesh.positions = {{-0.5F, -0.5F, 0.1F}, {0.5F, -0.5F, 0.1F}, {-0.5F, 0.5F, 0.1F}};
  mesh.directions = {a, b, c};
  mesh.triangles = {{0, 1, 2}};
  return std::make_shared<const Mesh>(mesh);
}

Light lightOf(const MeshPtr& mesh, const TexturePtr& texture = nullptr) {
  Light light;
  light.mesh = mesh;
  light.radiance = {5.0, 2.0, 0.5};
  light.texture = texture;
  return light;
}

DirectedEmission sumOf(const Grid& grid, const Light& light) {
  DirectedEmission sum;
  for (const FluxPair& pair : fluxPairs(grid, emittersOf(grid, light).triangles)) {
    sum.direction += pair.directed.direction;
    for (std::size_t c = 0; c < 3; ++c) sum.radiance[c] += pair.directed.radiance[c];
  }
  return sum;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "axis " << k;
}

glm::vec3 fan90(const glm::vec3& p) { return {2.0F * p.x, 0.0F, 1.0F}; }  // quad: 45 degrees to either side

TEST(DirectedFlux, DirectionsThatAreTheNormalChangeNothing) {
  const Grid grid = gridOf(9, 0.25);
  for (const TexturePtr& texture : {TexturePtr(), noise(5, 5)}) {
    Light light = lightOf(quadOf(2), texture);
    light.transform.rotation = rotationFromEulerDegrees({23, 41, 67});
    const Field plain = injectFlux(grid, emittersOf(grid, light).triangles);
    light.mesh = directed(light.mesh, [](const glm::vec3&) { return glm::vec3(0, 0, 3); });
    EXPECT_LE(relativeL2(injectFlux(grid, emittersOf(grid, light).triangles), plain), 1e-13);
  }
}

// Red when the lobe stands about the normal after all, or when bands get each other's constants.
TEST(DirectedFlux, ATiltedLightIsATiltedLobe) {
  const Grid grid = gridOf(8, 0.5);
  const glm::dvec3 tilt = glm::normalize(glm::dvec3(0.6, -0.3, 0.5));
  const Light light = lightOf(directed(quad(), [&](const glm::vec3&) { return glm::vec3(tilt); }));
  Coefficients sum(0.0);
  for (const auto& cell : injectFlux(grid, emittersOf(grid, light).triangles).cells) sum += cell[1];
  const Coefficients expected = 2.0 * lobe(tilt);
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(sum[k], expected[k], 1e-7);  // the tilt is a float
}

// Int (w, 0, 1) / sqrt(1 + w^2) dw / 2 over -1..1 = (0, 0, asinh 1). Red without the normalisation, or with one
// direction per pair.
TEST(DirectedFlux, AFanOf90DegreesHasItsClosedForm) {
  const Light light = lightOf(directed(quad(), fan90));
  const double z = std::asinh(1.0);
  for (const int cells : {5, 12}) {
    const DirectedEmission sum = sumOf(gridOf(cells, 6.0 / cells), light);
    expectNear(sum.direction, {0.0, 0.0, z}, 1e-12);
    for (int c = 0; c < 3; ++c) expectNear(sum.radiance[std::size_t(c)], {0.0, 0.0, z * light.radiance[c]}, 1e-11);
  }
}

// One triangle whose corners B and C share a direction at `angle` from A's: with v = 1 - 2 b0, S and C the sine and
// cosine of half the angle, Int d dA / area = (Int v^2 S / q dv, 0, Int C / q dv) over 0..1, q = sqrt(v^2 S^2 + C^2).
TEST(DirectedFlux, FansOfAnyAngleHaveTheirClosedForm) {
  for (const auto& [degrees, tolerance] :
       {std::pair(1.0, 1e-13), {30.0, 1e-13}, {120.0, 1e-13}, {170.0, 1e-13}, {179.0, 1e-11}, {179.9, 1e-9}}) {
    const double sine = std::sin(degrees * pi() / 360.0);
    const double cosine = std::cos(degrees * pi() / 360.0);
    Emitter e;
    e.corners = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 2, 0)};
    e.directions = {glm::dvec3(-sine, 0, cosine), glm::dvec3(sine, 0, cosine), glm::dvec3(sine, 0, cosine)};
    const double s = std::asinh(sine / cosine);
    const double x = 0.5 * (1.0 / sine - cosine * cosine / (sine * sine) * s);
    expectNear(directedIntegral(e, wholeTriangle()).direction, {x, 0.0, cosine / sine * s}, 10.0 * tolerance);
  }
}

// Texture and fan together: C = u, so Int C d dA = ((sqrt 2 - asinh 1) / 4, 0, asinh 1 / 2). Red when the mean of the
// texture multiplies the mean of the direction.
TEST(DirectedFlux, ARampOnAFanHasItsClosedForm) {
  const auto turned = directed(quad(), [](const glm::vec3& p) { return fan90(p); });
  Mesh mesh = *turned;
  for (glm::vec2& uv : mesh.uvs) uv = {0.25F + 0.5F * uv.x, 0.5F};  // from the centre of one texel to the other's
  const TexturePtr ramp = textureOf(2, 1, [](int x, int) { return glm::dvec3(x); });
  const Light light = lightOf(std::make_shared<const Mesh>(mesh), ramp);
  const glm::dvec3 expected(0.25 * (std::sqrt(2.0) - std::asinh(1.0)), 0.0, 0.5 * std::asinh(1.0));
  const DirectedEmission sum = sumOf(gridOf(7, 0.3), light);
  for (int c = 0; c < 3; ++c) expectNear(sum.radiance[std::size_t(c)], light.radiance[c] * expected, 1e-11);
}

// 6.1 closure: parts of a triangle make up the triangle, with and without a texture, however directions lie.
TEST(DirectedFlux, PairsAddUpToTheTriangle) {
  std::mt19937 random(4);
  std::normal_distribution<float> any;
  const Grid grid = gridOf(9, 0.25);
  for (const TexturePtr& texture : {TexturePtr(), noise(7, 4)}) {
    for (int i = 0; i < 6; ++i) {
      const auto direction = [&](const glm::vec3&) {
        const float x = any(random);
        const float y = any(random);
        return glm::vec3(x, y, 1.2F + any(random));
      };
      Light light = lightOf(directed(quad(), direction), texture);
      light.transform.rotation = rotationFromEulerDegrees({20.0 * i, 41, 67});
      const DirectedEmission sum = sumOf(grid, light);
      DirectedEmission whole;
      for (const Emitter& e : emittersOf(grid, light).triangles) {
        const DirectedEmission one = directedIntegral(e, wholeTriangle());
        whole.direction += one.direction;
        for (std::size_t c = 0; c < 3; ++c) whole.radiance[c] += one.radiance[c];
      }
      expectNear(sum.direction, whole.direction, 1e-9);
      for (std::size_t c = 0; c < 3; ++c) expectNear(sum.radiance[c], whole.radiance[c], 1e-9);
      EXPECT_LT(glm::length(sum.direction), 1.0);
    }
  }
}

// 6.9. Power is that of the area whatever directions do; where they cancel along a line, three quarters of the
// triangle point one way. Red without the fallback (NaN) or when a part counts with its mean direction's length.
TEST(DirectedFlux, AntipodalDirectionsKeepTheirPower) {
  const Grid grid = gridOf(9, 0.25);
  const glm::vec3 x(1, 0, 0);
  for (const double degrees : {0.0, 33.0}) {
    Light light = lightOf(triangleWith(-x, x, x));
    light.transform.rotation = rotationFromEulerDegrees({degrees, 2.0 * degrees, 0.0});
    const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
    const glm::dvec3 power = injectedPower(injectFlux(grid, emitters));
    EXPECT_NEAR(power.x / powerOf(emitters).x, 1.0, 1e-12);
    const glm::dvec3 turned = light.transform.rotation * glm::dvec3(x);
    expectNear(sumOf(grid, light).direction, 0.25 * turned, 1e-12);  // (3/4 - 1/4) of half a square metre
  }
}

// Three directions at 120 degrees in a plane cancel in one point. The barycentric image of the triangle is regular
// about that point, so the mean is 0.
TEST(DirectedFlux, DirectionsThatCancelInAPointAreFinite) {
  const float s = std::sqrt(3.0F) / 2.0F;
  const Light light = lightOf(triangleWith({0, 1, 0}, {s, -0.5F, 0}, {-s, -0.5F, 0}));
  const Grid grid = gridOf(6, 0.5);
  expectNear(sumOf(grid, light).direction, glm::dvec3(0.0), 1e-7);  // s is a float
  for (const auto& cell : injectFlux(grid, emittersOf(grid, light).triangles).cells) {
    for (int k = 0; k < 4; ++k) EXPECT_TRUE(std::isfinite(cell[0][k]));
  }
}

TEST(DirectedFlux, AZeroDirectionIsTheNormal) {
  const Grid grid = gridOf(6, 0.5);
  const glm::vec3 zero(0.0F);
  expectNear(sumOf(grid, lightOf(triangleWith(zero, zero, zero))).direction, {0.0, 0.0, 0.5}, 1e-14);
  const glm::vec3 tilt(0.6F, 0.0F, 0.8F);
  const DirectedEmission one = sumOf(grid, lightOf(triangleWith(zero, tilt, tilt)));
  const DirectedEmission same = sumOf(grid, lightOf(triangleWith({0, 0, 1}, tilt, tilt)));
  expectNear(one.direction, same.direction, 1e-14);
}

// Red with the inverse transpose, or when directions are normalised only before the transform.
TEST(DirectedFlux, DirectionsGoWithTheLinearPart) {
  const Grid grid = gridOf(10, 0.5);
  Light light = lightOf(triangleWith({1, 0, 1}, {1, 0, 1}, {0, 0, 1}));
  light.transform.scale = {2.0, 1.0, -1.0};
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  ASSERT_EQ(emitters.size(), 1U);
  const auto& d = *emitters[0].directions;
  expectNear(d[0], glm::normalize(glm::dvec3(2, 0, -1)), 1e-14);
  expectNear(d[1], {0, 0, -1}, 1e-14);  // the mirror exchanges the last two corners
  expectNear(d[2], glm::normalize(glm::dvec3(2, 0, -1)), 1e-14);
  expectNear(emitters[0].normal(), {0, 0, -1}, 1e-14);
}

TEST(DirectedFlux, TwoSidedLightsEmitTheOppositeToo) {
  const Grid grid = gridOf(8, 0.5);
  Light light = lightOf(directed(quad(), fan90));
  const Field once = injectFlux(grid, emittersOf(grid, light).triangles);
  light.twoSided = true;
  const Field twice = injectFlux(grid, emittersOf(grid, light).triangles);
  for (std::size_t i = 0; i < once.cells.size(); ++i) {
    EXPECT_NEAR(twice.cells[i][0].x, 2.0 * once.cells[i][0].x, 1e-14);
    for (int k = 1; k < 4; ++k) EXPECT_NEAR(twice.cells[i][0][k], 0.0, 1e-14);
  }
}

// 6.9 for FLUX itself: the faces of a plate thinner than a cell keep both powers and leave no direction.
TEST(DirectedFlux, AThinPlateHasThePowerOfBothFaces) {
  const Grid grid = gridOf(8, 0.5);
  const MeshPtr plate = box({-0.6, -0.6, 0.1}, {0.6, 0.6, 0.1001});
  const std::vector<Emitter> emitters = emittersOf(grid, lightOf(plate)).triangles;
  const Field field = injectFlux(grid, emitters);
  EXPECT_NEAR(injectedPower(field).x / powerOf(emitters).x, 1.0, 1e-12);
  for (const auto& cell : field.cells) EXPECT_LE(std::abs(cell[0].z), 1e-7 + 1e-7 * cell[0].x);
}

// 6.10: a light of 1e6 in the same cells leaves a dim one its digits.
TEST(DirectedFlux, LightsAddUp) {
  const Grid grid = gridOf(8, 0.5);
  Light dim = lightOf(directed(quad(), fan90), noise(8, 8));
  Light bright = lightOf(quadOf(3));
  bright.radiance = glm::dvec3(1e6);
  std::vector<Emitter> both = emittersOf(grid, dim).triangles;
  const std::vector<Emitter> other = emittersOf(grid, bright).triangles;
  const Field one = injectFlux(grid, both);
  const Field two = injectFlux(grid, other);
  both.insert(both.end(), other.begin(), other.end());
  const Field sum = injectFlux(grid, both);
  for (std::size_t i = 0; i < sum.cells.size(); ++i) {
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(sum.cells[i][0][k] - two.cells[i][0][k], one.cells[i][0][k], 1e-9);
  }
}

}  // namespace
}  // namespace lpv::reference
