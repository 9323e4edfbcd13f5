// FLUX in double: clipped polygons carry the light's whole power (MATHS.md 2, invariants 6.1, 6.2, 6.3, 6.5).
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>

#include "reference/clip_exact.h"
#include "reference/compare.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "scene/transform.h"
#include "unit/reference/fixtures.h"

namespace lpv::reference {
namespace {

Light lightOf(const MeshPtr& mesh) {
  Light light;
  light.mesh = mesh;
  light.radiance = {5.0, 2.0, 0.5};
  return light;
}

double powerRatio(const Grid& grid, const Light& light) {
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  return injectedPower(injectFlux(grid, emitters)).x / powerOf(emitters).x;
}

class FluxPower : public testing::TestWithParam<MeshPtr (*)()> {};

MeshPtr bumps() { return bumpySphere(2000); }

// Red when areas come from the snapped triangle, when a face is clipped with the wrong sign, or N divides the sum.
TEST_P(FluxPower, IsTheLightsPowerInEveryPose) {
  Light light = lightOf(GetParam()());
  std::mt19937 random(21);
  std::uniform_real_distribution<double> angle(-180.0, 180.0);
  std::uniform_real_distribution<double> offset(-0.5, 0.5);
  for (const int cells : {9, 22}) {
    for (int pose = 0; pose < 6; ++pose) {
      light.transform.rotation = rotationFromEulerDegrees({angle(random), angle(random), angle(random)});
      light.transform.translation = {offset(random), offset(random), offset(random)};
      light.transform.scale = {1.0, pose % 2 ? -0.7 : 1.3, 0.6};
      EXPECT_NEAR(powerRatio(gridOf(cells, 5.0 / cells), light), 1.0, 1e-11) << cells << " cells, pose " << pose;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(MeshesOfThePaper, FluxPower, testing::Values(&quad, &pyramid, &tube, &sphere, &bumps));

TEST(FluxInjection, PowerHoldsForLightsFarSmallerThanACell) {
  for (const double size : {0.4, 0.03, 1e-3, 1e-6}) {
    Light light = lightOf(sphere());
    light.transform.scale = glm::dvec3(size);
    light.transform.translation = {0.1234, -0.3217, 0.0771};
    EXPECT_NEAR(powerRatio(gridOf(8, 1.0), light), 1.0, 1e-11) << "size " << size;
  }
}

// Thinner than 1/256 cell they collapse to lines when snapped.
TEST(FluxInjection, PowerHoldsForTrianglesThatSnappingFlattens) {
  for (const double width : {1e-2, 1e-4, 1e-6}) {
    EXPECT_NEAR(powerRatio(gridOf(12, 0.25), lightOf(slivers(200, width))), 1.0, 1e-11) << "width " << width;
  }
}

TEST(FluxInjection, PowerCountsOnlyTheInsidePart) {
  Light light = lightOf(quad());  // 1 x 1 m in z = 0, half of it beyond x = 4
  light.transform.translation = {4.0, 0.0, 0.25};
  EXPECT_NEAR(powerRatio(gridOf(8, 1.0), light), 0.5, 1e-12);
  light.transform.translation = {5.0, 0.0, 0.25};
  EXPECT_EQ(powerRatio(gridOf(8, 1.0), light), 0.0);
  light.transform.scale = {1000.0, 1000.0, 1.0};
  light.transform.translation = {0.0, 0.0, 0.25};
  EXPECT_NEAR(powerRatio(gridOf(8, 1.0), light) * 1e6, 8.0 * 9.0, 1e-9);
}

// 6.1 closure, and against the exact clipper: the barycentric polygons are right to rounding.
TEST(FluxPairs, FractionsCloseAndEqualTheExactOnes) {
  const Grid grid = gridOf(8, 0.5);
  for (const MeshPtr& mesh : {bumpySphere(300), slivers(300, 1e-3), slivers(300, 1e-4)}) {
    Light light = lightOf(mesh);
    light.transform.scale = glm::dvec3(2.5);
    light.transform.rotation = rotationFromEulerDegrees({20, 40, 60});
    const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
    std::map<std::size_t, double> sums;
    for (const FluxPair& pair : fluxPairs(grid, emitters)) {
      const double exact = clippedFraction(emitters[pair.emitter].snapped, pair.cell, grid.dims);
      ASSERT_NEAR(pair.fraction, exact, 1e-13);
      sums[pair.emitter] += pair.fraction;
    }
    EXPECT_EQ(sums.size(), 300U);
    for (const auto& [emitter, sum] : sums) EXPECT_NEAR(sum, 1.0, 1e-12);
  }
}

TEST(FluxPairs, CentroidsLieInTheirCellsAndAverageToTheTriangles) {
  const Grid grid = gridOf(8, 0.5);
  Light light = lightOf(pyramid());
  light.transform.scale = glm::dvec3(1.9);  // wholly inside
  light.transform.rotation = rotationFromEulerDegrees({12, 34, 56});
  const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
  std::vector<glm::dvec3> moments(emitters.size(), glm::dvec3(0.0));
  for (const FluxPair& pair : fluxPairs(grid, emitters)) {
    moments[pair.emitter] += pair.areaCentroid;
    if (pair.area < 1e-9) continue;
    const glm::dvec3 g = grid.gridFromWorld(pair.areaCentroid / pair.area) - glm::dvec3(pair.cell);
    for (int k = 0; k < 3; ++k) {
      // Cut on the snapped triangle, placed on the unsnapped one: up to half a lattice unit apart.
      EXPECT_GE(g[k], -1.0 / 512);
      EXPECT_LE(g[k], 1.0 + 1.0 / 512);
    }
  }
  for (std::size_t i = 0; i < emitters.size(); ++i) {
    const auto& c = emitters[i].corners;
    EXPECT_NEAR(glm::length(moments[i] / emitters[i].area() - (c[0] + c[1] + c[2]) / 3.0), 0.0, 1e-12);
  }
}

// A closed surface has no area vector: the sum of band 1 over all cells is 0.
TEST(FluxInjection, ClosedMeshesHaveNoNetDirection) {
  const Grid grid = gridOf(9, 0.25);
  Light light = lightOf(sphere());
  light.transform.translation = {0.01, 0.02, 0.03};
  const Field field = injectFlux(grid, emittersOf(grid, light).triangles);
  Coefficients sum(0.0);
  for (const auto& cell : field.cells) sum += cell[0];
  // Float positions of the sphere close exactly as a mesh; what is left is rounding.
  for (int k = 1; k < 4; ++k) EXPECT_NEAR(sum[k] / sum.x, 0.0, 1e-13);
}

// 6.5: two or 20,000 triangles, the same light.
TEST(FluxInjection, TessellationDoesNotMatter) {
  const Grid grid = gridOf(9, 0.25);
  Light coarse = lightOf(quadOf(1));
  Light fine = lightOf(quadOf(100));
  for (Light* light : {&coarse, &fine}) {
    light->transform.rotation = rotationFromEulerDegrees({10, 20, 30});
  }
  const Field a = injectFlux(grid, emittersOf(grid, fine).triangles);
  const Field b = injectFlux(grid, emittersOf(grid, coarse).triangles);
  EXPECT_NEAR(injectedPower(a).x / injectedPower(b).x, 1.0, 1e-7);  // float positions of the fine quad
  // Per cell the two snap differently: at most half a lattice unit along a cell's border.
  EXPECT_LE(relativeL2(a, b), 4.0 / 512);
}

// 6.2: on a cell face the whole light is in one layer; a shift of 1e-12 changes nothing.
TEST(FluxInjection, ALightOnACellFaceStaysInOneLayer) {
  const Grid grid = gridOf(8, 0.5);  // dims 8 x 9 x 7, origin z = -1.75
  for (const double shift : {0.0, 1e-12, -1e-12}) {
    Light light = lightOf(quad());
    light.transform.translation = {0.1, 0.2, 0.25 + shift};  // grid z = 4
    const std::vector<Emitter> emitters = emittersOf(grid, light).triangles;
    for (const FluxPair& pair : fluxPairs(grid, emitters)) EXPECT_EQ(pair.cell.z, 4);
    EXPECT_NEAR(powerRatio(grid, light), 1.0, 1e-12);
  }
}

// 6.3: power while a light slides through a cell.
TEST(FluxInjection, PowerDoesNotFlickerUnderMotion) {
  const Grid grid = gridOf(8, 0.5);
  Light light = lightOf(pyramid());
  light.transform.rotation = rotationFromEulerDegrees({31, 17, 5});
  light.transform.scale = glm::dvec3(0.2);  // .4 of a cell
  double sum = 0.0;
  double squares = 0.0;
  for (int step = 0; step < 24; ++step) {
    light.transform.translation = {0.5 * step / 24.0, 0.1, 0.2};
    const double ratio = powerRatio(grid, light);
    sum += ratio / 24.0;
    squares += ratio * ratio / 24.0;
  }
  EXPECT_LE(std::sqrt(std::max(0.0, squares / (sum * sum) - 1.0)), 1e-6);
}

TEST(FluxInjection, TwoSidedLightsEmitTwice) {
  const Grid grid = gridOf(8, 0.5);
  Light light = lightOf(tube());
  light.transform.scale = glm::dvec3(0.8);
  const double once = injectedPower(injectFlux(grid, emittersOf(grid, light).triangles)).y;
  light.twoSided = true;
  EXPECT_NEAR(injectedPower(injectFlux(grid, emittersOf(grid, light).triangles)).y / once, 2.0, 1e-12);
  EXPECT_NEAR(powerRatio(grid, light), 1.0, 1e-11);
}

}  // namespace
}  // namespace lpv::reference
