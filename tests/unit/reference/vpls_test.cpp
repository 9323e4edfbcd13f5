// COUNT where triangles are not homogeneous: lobes between the corners of the box, and one mip sample (paper 3.2, 3.3).
#include "reference/vpls.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "reference/compare.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/pairs.h"
#include "reference/polygon.h"
#include "reference/sh.h"
#include "reference/texel.h"
#include "reference/textures.h"
#include "scene/transform.h"

namespace lpv::reference {
namespace {

constexpr double kPi = std::numbers::pi;

/// Cells of .25 m about the origin: the 1 m quad covers 4 x 4 columns exactly.
Grid gridOf(int cells = 8) {
  Grid grid;
  grid.cell = 0.25;
  grid.dims = glm::ivec3(cells);
  grid.origin = glm::dvec3(-0.125 * cells);
  return grid;
}

template <typename Direction>
MeshPtr directed(const MeshPtr& mesh, Direction direction) {
  Mesh out = *mesh;
  for (const glm::vec3& p : mesh->positions) out.directions.emplace_back(direction(p));
  return std::make_shared<const Mesh>(out);
}

Light lightOf(const MeshPtr& mesh, const TexturePtr& texture = nullptr) {
  Light light;
  light.mesh = mesh;
  light.texture = texture;
  light.transform.translation.z = 0.1;
  return light;
}

/// Directions from -half to +half about the y axis over x = -.125 .. .125: a quad of one cell spans twice `half`.
auto fan(double half) {
  return [half](const glm::vec3& p) { return glm::vec3(std::sin(half) * p.x / 0.125, 0.0, std::cos(half)); };
}

/// The 1 m quad scaled to exactly one column, with a fan over it. The fan is linear in x: both triangles agree on it.
std::vector<Emitter> fanOverOneCell(const Grid& grid, double half) {
  Mesh mesh = *quad();
  for (glm::vec3& p : mesh.positions) p *= 0.25F;
  Light light = lightOf(directed(std::make_shared<const Mesh>(mesh), fan(half)));
  light.transform.translation += glm::dvec3(0.125, 0.125, 0.0);
  return emittersOf(grid, light).triangles;
}

void expectNear(const glm::dvec3& a, const glm::dvec3& b, double tolerance) {
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[k], b[k], tolerance) << "axis " << k;
}

TEST(Lobes, StandAtMostAQuarterTurnApart) {
  const double degree = kPi / 180.0;
  EXPECT_EQ(lobesOver(0.0), 1);
  EXPECT_EQ(lobesOver(1e-8), 1);
  EXPECT_EQ(lobesOver(1.0 * degree), 2);
  EXPECT_EQ(lobesOver(90.0 * degree), 2);
  EXPECT_EQ(lobesOver(std::nextafter(90.0 * degree, 4.0)), 2);
  EXPECT_EQ(lobesOver(91.0 * degree), 3);
  EXPECT_EQ(lobesOver(180.0 * degree), 3);
}

TEST(ProjectionAxis, IsTheLargestOfTheNormalZBeforeYBeforeX) {
  const auto axisOf = [](const LatticePoint& b, const LatticePoint& c) {
    return projectionAxis(SnappedTriangle{{LatticePoint(0), b, c}});
  };
  EXPECT_EQ(axisOf({0, 9, 0}, {0, 0, 9}), 0);
  EXPECT_EQ(axisOf({9, 0, 0}, {0, 0, 9}), 1);
  EXPECT_EQ(axisOf({9, 0, 0}, {0, 9, 0}), 2);
  EXPECT_EQ(axisOf({1, -1, 0}, {1, 0, -1}), 2);  // (1, 1, 1)
  EXPECT_EQ(axisOf({1, -1, 0}, {0, 0, 1}), 1);  // (1, 1, 0)
  EXPECT_EQ(axisOf({1, 0, -1}, {0, 1, 0}), 2);  // (1, 0, 1)
}

// Against samples of the projected triangle within the square, and by the definition of barycentric coordinates.
TEST(Footprint, IsTheBoxOfTheProjectionWithinTheColumn) {
  std::mt19937 random(6);
  std::uniform_int_distribution<std::int64_t> at(0, 4 * kUnitsPerCell);
  const glm::ivec3 dims(4);
  for (int i = 0; i < 20; ++i) {
    SnappedTriangle t;
    for (LatticePoint& p : t.corners) p = {at(random), at(random), at(random)};
    const int axis = projectionAxis(t);
    for (const glm::ivec3& cell : cellsOf(t, dims)) {
      const Footprint footprint = footprintOf(t, cell);
      const auto place = [&](const glm::dvec3& b) {
        return glm::dvec2(coordinate(t, b, (axis + 1) % 3, 0), coordinate(t, b, (axis + 2) % 3, 0));
      };
      glm::dvec2 low(1e9);
      glm::dvec2 high(-1e9);
      const glm::dvec2 corner = 256.0 * glm::dvec2(cell[(axis + 1) % 3], cell[(axis + 2) % 3]);
      for (int r = 0; r <= 300; ++r) {
        for (int s = 0; s + r <= 300; ++s) {
          const glm::dvec2 p = place(glm::dvec3(300 - r - s, r, s) / 300.0);
          if (p.x < corner.x || p.y < corner.y || p.x > corner.x + 256 || p.y > corner.y + 256) continue;
          low = glm::min(low, p);
          high = glm::max(high, p);
        }
      }
      const glm::dvec2 boxLow = place(footprint.corners[0]);
      const glm::dvec2 boxHigh = place(footprint.corners[3]);
      for (int k = 0; k < 2; ++k) {
        EXPECT_LE(boxLow[k], low[k] + 1e-6);
        EXPECT_GE(boxHigh[k], high[k] - 1e-6);
        if (high.x < low.x) continue;  // smaller than the samples' distance
        EXPECT_GE(boxLow[k], low[k] - 20.0);
        EXPECT_LE(boxHigh[k], high[k] + 20.0);
      }
      expectNear({place(footprint.corners[1]), 0}, {boxHigh.x, boxLow.y, 0}, 1e-6);
      expectNear({place(footprint.corners[2]), 0}, {boxLow.x, boxHigh.y, 0}, 1e-6);
      expectNear({place(footprint.centre), 0}, glm::dvec3(0.5 * (boxLow + boxHigh), 0), 1e-6);
    }
  }
}

// Red with one lobe per pair, N counted per pair, or the corner directions weighted instead of mixed.
TEST(DirectedCount, AFanOf90DegreesIsTwoLobes) {
  const Grid grid = gridOf();
  const std::vector<Emitter> emitters = fanOverOneCell(grid, 0.25 * kPi);
  const Counted counted = injectCount(grid, emitters);
  const glm::ivec3 cell(4, 4, 4);
  EXPECT_EQ(counted.lobes[grid.index(cell)], 4U);
  const Coefficients expected =
      0.5 * 0.0625 * (lobe({std::sqrt(0.5), 0, std::sqrt(0.5)}) + lobe({-std::sqrt(0.5), 0, std::sqrt(0.5)}));
  for (int k = 0; k < 4; ++k) EXPECT_NEAR(counted.intensity.at(cell)[1][k], expected[k], 1e-8);
  std::uint32_t all = 0;
  for (const std::uint32_t n : counted.lobes) all += n;
  EXPECT_EQ(all, 4U);
}

TEST(DirectedCount, AFanOf120DegreesIsThreeLobes) {
  const Grid grid = gridOf();
  for (const Emitter& e : fanOverOneCell(grid, kPi / 3.0)) {
    const Vpls vpls = vplsOf(e, {4, 4, 4});
    ASSERT_EQ(vpls.directions.size(), 3U);
    expectNear(vpls.directions[0], {-std::sin(kPi / 3.0), 0, 0.5}, 1e-6);
    expectNear(vpls.directions[1], {0, 0, 1}, 1e-6);
    expectNear(vpls.directions[2], {std::sin(kPi / 3.0), 0, 0.5}, 1e-6);
  }
}

// 6.9: from -x to +x, what is between cancels: the normal. Red without the fallback: NaN.
TEST(DirectedCount, BetweenAntipodesStandsTheNormal) {
  const Grid grid = gridOf();
  Mesh mesh = *quad();
  for (glm::vec3& p : mesh.positions) p *= 0.25F;
  const auto away = [](const glm::vec3& p) { return glm::vec3(p.x, 0, 0); };
  Light light = lightOf(directed(std::make_shared<const Mesh>(mesh), away));
  light.transform.translation += glm::dvec3(0.125, 0.125, 0.0);
  for (const Emitter& e : emittersOf(grid, light).triangles) {
    const Vpls vpls = vplsOf(e, {4, 4, 4});
    ASSERT_EQ(vpls.directions.size(), 3U);
    expectNear(vpls.directions[0], {-1, 0, 0}, 1e-12);
    expectNear(vpls.directions[1], {0, 0, 1}, 1e-12);
    expectNear(vpls.directions[2], {1, 0, 0}, 1e-12);
  }
}

// Fans along both axes make a lattice: 2 x 3 lobes here.
TEST(DirectedCount, LobesFillBothAxes) {
  Emitter e;
  e.corners = {glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)};
  e.snapped = SnappedTriangle{{LatticePoint(0), LatticePoint(256, 0, 0), LatticePoint(0, 256, 0)}};
  e.directions = {glm::dvec3(0, 0, 1), glm::normalize(glm::dvec3(1, 0, 1)), glm::normalize(glm::dvec3(0, 2, -1))};
  EXPECT_EQ(vplsOf(e, glm::ivec3(0)).directions.size(), 6U);
}

TEST(DirectedCount, EqualDirectionsAreOneLobe) {
  const Grid grid = gridOf();
  const Counted plain = injectCount(grid, emittersOf(grid, lightOf(quad())).triangles);
  const auto normal = [](const glm::vec3&) { return glm::vec3(0, 0, 0.3F); };
  const Counted same = injectCount(grid, emittersOf(grid, lightOf(directed(quad(), normal))).triangles);
  EXPECT_EQ(same.lobes, plain.lobes);
  EXPECT_LE(relativeL2(same.intensity, plain.intensity), 1e-13);
}

// The set is made once per column. Red when the box is cut in depth too.
TEST(DirectedCount, CellsOfAColumnShareTheirLobes) {
  const Grid grid = gridOf();
  Light light = lightOf(directed(quad(), [](const glm::vec3& p) { return glm::vec3(p.x, p.y, 0.2F); }));
  light.transform.rotation = rotationFromEulerDegrees({0, 38, 0});
  int shared = 0;
  for (const Emitter& e : emittersOf(grid, light).triangles) {
    const int axis = projectionAxis(e.snapped);
    const std::vector<glm::ivec3> cells = cellsOf(e.snapped, grid.dims);
    for (const glm::ivec3& cell : cells) {
      glm::ivec3 behind = cell;
      ++behind[axis];
      if (std::find(cells.begin(), cells.end(), behind) == cells.end()) continue;
      ++shared;
      EXPECT_EQ(vplsOf(e, cell).directions, vplsOf(e, behind).directions);
    }
  }
  EXPECT_GT(shared, 3);
}

TEST(DirectedCount, TwoSidedLobesHaveOppositesAndCountTwice) {
  const Grid grid = gridOf();
  std::vector<Emitter> emitters = fanOverOneCell(grid, 0.25 * kPi);
  for (Emitter& e : emitters) e.twoSided = true;
  const Counted counted = injectCount(grid, emitters);
  const glm::ivec3 cell(4, 4, 4);
  EXPECT_EQ(counted.lobes[grid.index(cell)], 8U);
  EXPECT_NEAR(counted.intensity.at(cell)[0].x, 0.0625 * lobe({0, 0, 1}).x, 1e-14);
  for (int k = 1; k < 4; ++k) EXPECT_NEAR(counted.intensity.at(cell)[0][k], 0.0, 1e-14);
}

// A line on the lattice has no box: in each of its cells one lobe, the mean direction there.
TEST(DirectedCount, ATriangleThatSnappingFlattensIsOneLobe) {
  const Grid grid = gridOf();
  Mesh mesh = *slivers(1, 1e-5);
  mesh.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  const std::vector<Emitter> emitters = emittersOf(grid, lightOf(std::make_shared<const Mesh>(mesh))).triangles;
  const std::vector<glm::ivec3> cells = cellsOf(emitters.at(0).snapped, grid.dims);
  ASSERT_GT(cells.size(), 1U);
  glm::dvec3 sum(0.0);
  for (const glm::ivec3& cell : cells) {
    const Vpls vpls = vplsOf(emitters[0], cell);
    ASSERT_EQ(vpls.directions.size(), 1U);
    // The directions are the axes: a mix of them is the barycentric coordinates, at unit length.
    const glm::dvec3& d = vpls.directions[0];
    sum += measure(partInCell(emitters[0].snapped, cell)).fraction * d / (d.x + d.y + d.z);
  }
  expectNear(sum, glm::dvec3(1.0 / 3.0), 1e-12);
}

// 16 x 16 texels per column: level 4, whose texel centres are the columns' centres. Red with a level more or less,
// with the sample at a corner, or with W and H exchanged.
TEST(TexturedCount, AColumnReadsTheMeanOfItsTexels) {
  const Grid grid = gridOf();
  for (const glm::ivec2 size : {glm::ivec2(64, 64), glm::ivec2(64, 16), glm::ivec2(16, 64)}) {
    const TexturePtr texture = noise(size.x, size.y);
    const MipChain chain = mipChainOf(*texture);
    const Light light = lightOf(quad(), texture);
    for (const Emitter& e : emittersOf(grid, light).triangles) {
      for (const glm::ivec3& cell : cellsOf(e.snapped, grid.dims)) {
        EXPECT_NEAR(levelOfDetail(e, footprintOf(e.snapped, cell)), 4.0, 1e-12);
        const glm::dvec2 uv((cell.x - 2 + 0.5) / 4.0, (6 - cell.y - 0.5) / 4.0);
        expectNear(vplsOf(e, cell).radiance, bilinear(chain.levels[4], uv), 1e-12);
        if (size.x != size.y) continue;
        glm::dvec3 mean(0.0);
        for (int y = 0; y < 16; ++y) {
          for (int x = 0; x < 16; ++x) {
            mean += texel(*texture, (cell.x - 2) * 16 + x, (5 - cell.y) * 16 + y) / 256.0;
          }
        }
        expectNear(vplsOf(e, cell).radiance, mean, 1e-12);
      }
    }
  }
}

TEST(TexturedCount, MagnifiedTexturesAreReadFromLevelZero) {
  const Grid grid = gridOf();
  const TexturePtr texture = noise(2, 2);
  for (const Emitter& e : emittersOf(grid, lightOf(quad(), texture)).triangles) {
    for (const glm::ivec3& cell : cellsOf(e.snapped, grid.dims)) {
      const glm::dvec2 uv((cell.x - 2 + 0.5) / 4.0, (6 - cell.y - 0.5) / 4.0);
      expectNear(vplsOf(e, cell).radiance, bilinear(*texture, uv), 1e-12);
    }
  }
}

TEST(TexturedCount, OneUvForAllIsReadFromLevelZero) {
  const Grid grid = gridOf();
  Mesh mesh = *quad();
  for (glm::vec2& uv : mesh.uvs) uv = {0.25F, 0.75F};
  const TexturePtr texture = noise(64, 64);
  const Light light = lightOf(std::make_shared<const Mesh>(mesh), texture);
  const Emitter e = emittersOf(grid, light).triangles[0];
  const glm::ivec3 cell = cellsOf(e.snapped, grid.dims)[0];
  EXPECT_EQ(levelOfDetail(e, footprintOf(e.snapped, cell)), -std::numeric_limits<double>::infinity());
  expectNear(vplsOf(e, cell).radiance, bilinear(*texture, glm::dvec2(0.25, 0.75)), 1e-13);
}

TEST(TexturedCount, AConstantTextureIsAFactor) {
  const Grid grid = gridOf();
  Light light = lightOf(quadOf(3), textureOf(8, 4, [](int, int) { return glm::dvec3(0.5, 0.25, 2.0); }));
  light.transform.rotation = rotationFromEulerDegrees({12, 34, 56});
  const Counted textured = injectCount(grid, emittersOf(grid, light).triangles);
  light.texture = nullptr;
  light.radiance *= glm::dvec3(0.5, 0.25, 2.0);
  const Counted plain = injectCount(grid, emittersOf(grid, light).triangles);
  EXPECT_LE(relativeL2(textured.intensity, plain.intensity), 1e-13);
  EXPECT_EQ(textured.lobes, plain.lobes);
}

}  // namespace
}  // namespace lpv::reference
