// COUNT in double: eq. (1) with i = 1..N, times one cell face (MATHS.md 2).
#include "reference/inject.h"

#include <gtest/gtest.h>

#include <cmath>

#include "reference/compare.h"
#include "reference/meshes.h"
#include "reference/pairs.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

constexpr double kCell = 0.5;

Grid gridOf(int cells) {
  Grid grid;
  grid.cell = kCell;
  grid.dims = glm::ivec3(cells);
  grid.origin = glm::dvec3(-0.5 * cells * kCell);
  return grid;
}

Light lightOf(const MeshPtr& mesh, const glm::dvec3& radiance = {3.0, 2.0, 1.0}) {
  Light light;
  light.mesh = mesh;
  light.radiance = radiance;
  return light;
}

TEST(CountInjection, OneTriangleGivesOneFaceOfItsRadiancePerCell) {
  const Grid grid = gridOf(8);
  const Light light = lightOf(quad());
  const Counted counted = injectCount(grid, emittersOf(grid, light).triangles);
  const Coefficients expected = kCell * kCell * lobe({0, 0, 1});
  int lit = 0;
  forEachCell(grid.dims, [&](const glm::ivec3& cell) {
    if (counted.lobes[grid.index(cell)] == 0) {
      EXPECT_EQ(counted.intensity.at(cell)[0], Coefficients(0.0));
      return;
    }
    ++lit;
    EXPECT_EQ(cell.z, 4);  // the quad lies in z = 0, a face: the upper layer
    for (int colour = 0; colour < 3; ++colour) {
      for (int k = 0; k < 4; ++k) {
        EXPECT_NEAR(counted.intensity.at(cell)[std::size_t(colour)][k], light.radiance[colour] * expected[k], 1e-15);
      }
    }
  });
  EXPECT_EQ(lit, 4);  // 1 m over cells of .5 m, both triangles in some of them: the mean stays
}

// Red with the paper's weight 1/N over N + 1 terms, without s^2, or with N counted per triangle.
TEST(CountInjection, NIsTheNumberOfLobesInTheCell) {
  const Grid grid = gridOf(8);
  Light light = lightOf(pyramid());
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  const Counted counted = injectCount(grid, emitters);
  std::vector<std::uint32_t> pairs(grid.cells());
  std::vector<SnappedTriangle> snapped;
  snapped.reserve(emitters.size());
  for (const Emitter& e : emitters) snapped.push_back(e.snapped);
  for (const Pair& pair : pairsOf(snapped, grid.dims)) ++pairs[grid.index(pair.cell)];
  EXPECT_EQ(counted.lobes, pairs);
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    if (pairs[i] == 0) continue;
    // Every lobe has the same band 0, so the mean has it too: one cell face of emitter per occupied cell.
    EXPECT_NEAR(counted.intensity.cells[i][0].x, 3.0 * kCell * kCell * lobe({0, 1, 0}).x, 1e-14);
  }
}

TEST(CountInjection, TwoSidedCountsTwiceAndKeepsNoDirection) {
  const Grid grid = gridOf(8);
  Light light = lightOf(quad());
  light.twoSided = true;
  const Counted counted = injectCount(grid, emittersOf(grid, light).triangles);
  for (std::size_t i = 0; i < counted.lobes.size(); ++i) {
    EXPECT_EQ(counted.lobes[i] % 2, 0U);
    for (int k = 1; k < 4; ++k) EXPECT_NEAR(counted.intensity.cells[i][0][k], 0.0, 1e-15);
    const double band0 = counted.lobes[i] > 0 ? 2.0 * kCell * kCell * lobe({0, 0, 1}).x : 0.0;
    EXPECT_NEAR(counted.intensity.cells[i][1].x, band0, 1e-14);
  }
}

TEST(CountInjection, IsLinearInRadianceAndBlindToVertexOrder) {
  const Grid grid = gridOf(8);
  const Field one = injectCount(grid, emittersOf(grid, lightOf(sphere(), {1, 1, 1})).triangles).intensity;
  Field many = injectCount(grid, emittersOf(grid, lightOf(sphere(), {7, 7, 7})).triangles).intensity;
  for (auto& cell : many.cells) {
    for (Coefficients& c : cell) c /= 7.0;
  }
  EXPECT_LE(relativeL2(many, one), 1e-14);
  Mesh turned = *sphere();
  for (glm::uvec3& t : turned.triangles) t = {t.y, t.z, t.x};
  const Light light = lightOf(std::make_shared<const Mesh>(turned), {1, 1, 1});
  EXPECT_LE(relativeL2(injectCount(grid, emittersOf(grid, light).triangles).intensity, one), 1e-14);
}

TEST(Emitters, WindingFlipsTheSideAndAMirrorDoesNot) {
  const Grid grid = gridOf(8);
  Mesh flipped = *quad();
  for (glm::uvec3& t : flipped.triangles) t = {t.x, t.z, t.y};
  const Emitters back = emittersOf(grid, lightOf(std::make_shared<const Mesh>(flipped)));
  EXPECT_LT(back.triangles[0].areaNormal().z, 0.0);
  Light mirrored = lightOf(quad());
  mirrored.transform.scale = {-1.0, 1.0, 1.0};
  EXPECT_GT(emittersOf(grid, mirrored).triangles[0].areaNormal().z, 0.0);
  mirrored.transform.scale = {1.0, 1.0, -1.0};  // object-space outer side is +z: mirrored, it looks to -z
  EXPECT_LT(emittersOf(grid, mirrored).triangles[0].areaNormal().z, 0.0);
}

TEST(Emitters, SkipsAndCountsTrianglesOfNoArea) {
  const Grid grid = gridOf(4);
  Mesh mesh = *quad();
  mesh.triangles.emplace_back(0, 0, 1);
  mesh.triangles.emplace_back(2, 2, 2);
  const Emitters emitters = emittersOf(grid, lightOf(std::make_shared<const Mesh>(mesh)));
  EXPECT_EQ(emitters.triangles.size(), 2U);
  EXPECT_EQ(emitters.degenerate, 2U);
}

TEST(Emitters, DisabledLightsAndLightsOutsideInjectNothing) {
  const Grid grid = gridOf(4);
  Light light = lightOf(quad());
  light.transform.translation = {0, 0, 40};
  EXPECT_EQ(injectedPower(injectCount(grid, emittersOf(grid, light).triangles).intensity), glm::dvec3(0.0));
  light.enabled = false;
  EXPECT_TRUE(emittersOf(grid, light).triangles.empty());
}

TEST(Emitters, PowerBecomesRadianceOverPiAreaSides) {
  Light light = lightOf(sphere());
  light.transform.scale = glm::dvec3(3.0);
  light.power = glm::dvec3(30.0, 20.0, 10.0);
  light.twoSided = true;
  const glm::dvec3 power = powerOf(emittersOf(gridOf(16), light).triangles);
  EXPECT_NEAR(power.x, 30.0, 1e-12);
  EXPECT_NEAR(power.z, 10.0, 1e-12);
}

}  // namespace
}  // namespace lpv::reference
