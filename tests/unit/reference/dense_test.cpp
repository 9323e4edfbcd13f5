// The paper's baseline of many samples per triangle (4.1).
#include "reference/dense.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "reference/clip_exact.h"
#include "reference/compare.h"
#include "reference/meshes.h"
#include "reference/pairs.h"
#include "reference/sh.h"
#include "reference/textures.h"

namespace lpv::reference {
namespace {

Grid gridOf(int cells, double edge) {
  Grid grid;
  grid.cell = edge;
  grid.dims = glm::ivec3(cells);
  grid.origin = glm::dvec3(-0.5 * cells * edge);
  return grid;
}

Light lightOf(const MeshPtr& mesh) {
  Light light;
  light.mesh = mesh;
  light.radiance = {3.0, 2.0, 1.0};
  light.transform.rotation = rotationFromEulerDegrees({12, 34, 56});
  return light;
}

/// Always the same place: corner A, B or C.
SampleSource cornerOf(int corner) {
  return
      [corner](std::uint32_t, std::uint32_t) { return glm::dvec2(corner == 0 ? 0.0 : 1.0, corner == 2 ? 1.0 : 0.0); };
}

// Published values of the finaliser: MurmurHash3_x86_32 of nothing with seeds 1 and 0xffffffff.
TEST(Hash, IsTheMurmurFinaliser) {
  EXPECT_EQ(fmix32(0U), 0U);
  EXPECT_EQ(fmix32(1U), 0x514E28B7U);
  EXPECT_EQ(fmix32(0xFFFFFFFFU), 0x81F16F39U);
}

TEST(Hash, PairsAreInsideTheUnitSquareAndSpread) {
  EXPECT_EQ(hashedPair(0, 0).x, 0x1p-25);
  for (const std::uint32_t triangle : {0U, 1U, 719U, 33445U}) {
    std::array<int, 64> boxes{};
    std::set<std::pair<double, double>> different;
    for (std::uint32_t i = 0; i < 6400; ++i) {
      const glm::dvec2 r = hashedPair(triangle, i);
      ASSERT_TRUE(r.x > 0.0 && r.x < 1.0 && r.y > 0.0 && r.y < 1.0);
      different.emplace(r.x, r.y);
      ++boxes[std::size_t(8.0 * r.x) * 8 + std::size_t(8.0 * r.y)];
    }
    double chiSquared = 0.0;  // 63 degrees of freedom: mean 63, standard deviation 11
    for (const int n : boxes) chiSquared += (n - 100.0) * (n - 100.0) / 100.0;
    EXPECT_LT(chiSquared, 120.0);
    EXPECT_EQ(different.size(), 6400U);
  }
}

TEST(DenseInjection, SamplesLieWhereTurkPutsThem) {
  const glm::dvec3 b = turk({0.25, 0.3});
  EXPECT_NEAR(b.x, 0.5, 1e-15);
  EXPECT_NEAR(b.y, 0.35, 1e-15);
  EXPECT_NEAR(b.z, 0.15, 1e-15);
}

// Red without the square root: samples crowd at A.
TEST(DenseInjection, SamplesAreUniformOverTheArea) {
  const Grid grid = gridOf(6, 0.3);
  const std::vector<Emitter> emitters = emittersOf(grid, lightOf(quad())).triangles;
  constexpr std::uint32_t kSamples = 40000;
  const Counted counted = injectDense(grid, {emitters[0]}, kSamples);
  forEachCell(grid.dims, [&](const glm::ivec3& cell) {
    const double share = clippedFraction(emitters[0].snapped, cell, grid.dims);
    const double deviation = std::sqrt(share * (1.0 - share) / kSamples);
    EXPECT_NEAR(counted.lobes[grid.index(cell)] / double(kSamples), share, 5.0 * deviation + 0.004);  // snapped share
  });
}

TEST(DenseInjection, EverySampleIsCountedOnceAndTwiceOnTwoSides) {
  const Grid grid = gridOf(12, 0.2);
  Light light = lightOf(sphere());
  for (const std::uint32_t sides : {1U, 2U}) {
    light.twoSided = sides == 2;
    const Counted counted = injectDense(grid, emittersOf(grid, light).triangles, 10);
    std::uint32_t all = 0;
    for (const std::uint32_t n : counted.lobes) all += n;
    EXPECT_EQ(all, 7200U * sides);
  }
}

// On a flat light every lobe is the same: cells that dense samples reach hold what COUNT puts there.
TEST(DenseInjection, ConvergesToCountOnAFlatLight) {
  const Grid grid = gridOf(8, 0.25);
  const std::vector<Emitter> emitters = emittersOf(grid, lightOf(quad())).triangles;
  const Counted count = injectCount(grid, emitters);
  const Counted dense = injectDense(grid, emitters, 2000);
  double area = 0.0;  // of COUNT's cells that no sample reached
  for (std::size_t i = 0; i < dense.lobes.size(); ++i) {
    if (dense.lobes[i] == 0) {
      area += count.lobes[i] > 0 ? 1.0 : 0.0;
      continue;
    }
    for (int k = 0; k < 4; ++k) EXPECT_NEAR(dense.intensity.cells[i][0][k], count.intensity.cells[i][0][k], 1e-13);
  }
  EXPECT_LE(area, 3.0);
}

// Half-open cells, the grid's upper face with the last, nothing outside.
TEST(DenseInjection, SamplesGoToTheCellThatHoldsThem) {
  const Grid grid = gridOf(4, 1.0);
  const auto cellOf = [&](const glm::dvec3& world) {
    Emitter e;
    e.corners = {world, world + glm::dvec3(0.1, 0, 0), world + glm::dvec3(0, 0.1, 0)};
    const Counted counted = injectDense(grid, {e}, 1, cornerOf(0));
    glm::ivec3 found(-1);
    forEachCell(grid.dims, [&](const glm::ivec3& cell) {
      if (counted.lobes[grid.index(cell)] > 0) found = cell;
    });
    return found;
  };
  EXPECT_EQ(cellOf({0.0, -0.1, 1.0}), glm::ivec3(2, 1, 3));
  EXPECT_EQ(cellOf({2.0, 2.0, 2.0}), glm::ivec3(3));
  EXPECT_EQ(cellOf({-2.0, -2.0, -2.0}), glm::ivec3(0));
  EXPECT_EQ(cellOf({2.01, 0.0, 0.0}), glm::ivec3(-1));
  EXPECT_EQ(cellOf({0.0, -2.01, 0.0}), glm::ivec3(-1));
}

// A mirror turns the winding back, not the samples: B is the mesh's second vertex. Red without `swapped`.
TEST(DenseInjection, CornersKeepTheMeshsOrderUnderAMirror) {
  const Grid grid = gridOf(8, 0.25);
  Light light = lightOf(quad());
  light.transform.scale.x = -1.0;
  const Emitter e = emittersOf(grid, light).triangles.at(0);
  const glm::uvec3 t = light.mesh->triangles[0];
  for (int corner = 0; corner < 3; ++corner) {
    const Counted counted = injectDense(grid, {e}, 1, cornerOf(corner));
    const glm::dvec4 object(glm::dvec3(light.mesh->positions[t[corner]]), 1.0);
    const glm::dvec3 g = grid.gridFromWorld(glm::dvec3(light.transform.worldFromObject() * object));
    EXPECT_EQ(counted.lobes[grid.index(glm::ivec3(glm::floor(g)))], 1U) << corner;
  }
}

TEST(DenseInjection, SamplesHaveTheirOwnDirectionAndColour) {
  const Grid grid = gridOf(1, 4.0);
  Mesh mesh = *quad();
  mesh.directions = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {-1, 0, 0}};
  Light light = lightOf(std::make_shared<const Mesh>(mesh));
  light.transform = Transform();
  light.texture = noise(4, 4);
  const Emitter e = emittersOf(grid, light).triangles.at(0);
  const Counted counted = injectDense(grid, {e}, 1, cornerOf(1));
  const std::uint32_t vertex = mesh.triangles[0].y;
  const glm::dvec3 colour = bilinear(e.texture->levels[0], glm::dvec2(mesh.uvs[vertex]));
  const Coefficients expected = 16.0 * lobe(glm::dvec3(mesh.directions[vertex]));
  for (int c = 0; c < 3; ++c) {
    for (int k = 0; k < 4; ++k) {
      EXPECT_NEAR(counted.intensity.cells[0][std::size_t(c)][k], light.radiance[c] * colour[c] * expected[k], 1e-12);
    }
  }
}

}  // namespace
}  // namespace lpv::reference
