// Injection sums against the double reference (paper eq. 1; MATHS.md 2, COUNT), and the fixed point at its limit.

#include "reference/inject.h"

#include <glm/gtc/matrix_transform.hpp>

#include "gpu/support/light_rig.h"
#include "gpu/support/stage_rig.h"
#include "reference/compare.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "scene/sh.h"

namespace lpv {
namespace {

class InjectTest : public test::GlTest {};

std::vector<reference::Emitter> emittersOf(const Grid& grid, const std::vector<EmittingLight>& lights) {
  std::vector<reference::Emitter> out;
  for (const EmittingLight& light : lights) {
    const reference::Emitters e =
        reference::emittersOf(grid, *light.mesh, light.gridFromObject, light.radiance, light.twoSided);
    out.insert(out.end(), e.triangles.begin(), e.triangles.end());
  }
  return out;
}

/// Largest difference as a share of the largest coefficient there can be.
double error(const Grid& grid, const test::InjectRig& rig, double radianceScale) {
  const reference::Counted want = reference::injectCount(grid, emittersOf(grid, rig.lights));
  const reference::Field got = test::fieldOf(rig.field.injected, rig.field, rig.palette);
  return reference::largestDifference(got, want.intensity) / (radianceScale * reference::lobe({0, 0, 1}).z);
}

EmittingLight placed(const MeshPtr& mesh, const glm::dvec3& at, double size, const glm::dvec3& radiance,
                     bool twoSided = false) {
  EmittingLight light = test::lightOf(mesh, radiance, twoSided);
  light.gridFromObject = glm::translate(glm::dmat4(1.0), at) *
                         glm::rotate(glm::dmat4(1.0), 0.7, glm::normalize(glm::dvec3(1, 2, 3))) *
                         glm::scale(glm::dmat4(1.0), glm::dvec3(size));
  return light;
}

// Broken by: dividing by N + 1; leaving out the division; lobes not normalised; kCountWord off by one.
TEST_F(InjectTest, SumsAreTheReferences) {
  const Grid grid = test::unitGrid({16, 12, 14});
  for (const MeshPtr& mesh : {reference::quad(), reference::pyramid(), reference::tube(), reference::sphere(),
                              reference::bumpySphere(4000)}) {
    const test::InjectRig rig(grid, {placed(mesh, {7.1, 6.3, 6.9}, 5.0, {3.0, 2.0, 1.0})});
    EXPECT_LE(error(grid, rig, 3.0), rig.roundingError() + 1e-6) << mesh->triangles.size() << " triangles";
    EXPECT_GT(rig.touched(), 0U);
  }
}

// Broken by: s^2 left out, s for s^2.
TEST_F(InjectTest, IntensityGrowsWithTheFaceOfACell) {
  const MeshPtr mesh = reference::quad();
  test::InjectRig one(test::unitGrid({8, 8, 8}), {placed(mesh, {4, 4, 4}, 3.0, glm::dvec3(1.0))});
  Grid wide = test::unitGrid({8, 8, 8});
  wide.cell = 0.25;
  test::InjectRig other(wide, one.lights);
  reference::Field a = test::fieldOf(one.field.injected, one.field, one.palette);
  const reference::Field b = test::fieldOf(other.field.injected, other.field, other.palette);
  for (auto& cell : a.cells) {
    for (auto& c : cell) c /= 16.0;
  }
  EXPECT_LE(reference::largestDifference(a, b), 1e-7);
}

// Broken by: counting a two-sided triangle once; keeping its band 1.
TEST_F(InjectTest, TwoSidedLightsCountTwice) {
  const Grid grid = test::unitGrid({10, 10, 10});
  const test::InjectRig rig(grid, {placed(reference::sphere(), {5.2, 4.9, 5.3}, 4.0, glm::dvec3(2.0), true),
                                   placed(reference::quad(), {5.2, 4.9, 5.3}, 6.0, glm::dvec3(2.0))});
  EXPECT_LE(error(grid, rig, 2.0), rig.roundingError() + 1e-6);
}

// A mirror keeps the object-space outer side. Broken by: leaving the determinant's sign out of outwardFromObject.
TEST_F(InjectTest, MirrorsAndUnevenScalesKeepTheOuterSide) {
  const Grid grid = test::unitGrid({12, 12, 12});
  EmittingLight light = placed(reference::sphere(), {6.2, 6.1, 5.7}, 1.0, glm::dvec3(1.0));
  light.gridFromObject = light.gridFromObject * glm::scale(glm::dmat4(1.0), glm::dvec3(-7.0, 3.0, 5.0));
  light.mirrored = true;
  const test::InjectRig rig(grid, {light});
  EXPECT_LE(error(grid, rig, 1.0), rig.roundingError() + 1e-6);
  // The right side from right to left would emit leftwards if the mirror turned the mesh inside out.
  const reference::Field field = test::fieldOf(rig.field.injected, rig.field, rig.palette);
  double outward = 0.0;
  reference::forEachCell(grid.dims, [&](const glm::ivec3& c) {
    const reference::Coefficients& l = field.at(c)[0];
    outward += glm::dot(glm::dvec3(l.w, l.y, l.z), glm::dvec3(c) + 0.5 - glm::dvec3(6.2, 6.1, 5.7));
  });
  EXPECT_GT(outward, 0.0);
}

// 1, 2 and 3 channels of the palette. Broken by: weights of the wrong channel; a channel's colour of its dimmest light.
TEST_F(InjectTest, LightsOfSeveralColoursShareCells) {
  const Grid grid = test::unitGrid({10, 10, 10});
  std::vector<EmittingLight> lights;
  const std::vector<glm::dvec3> colours = {{4, 2, 1}, {2, 1, 0.5}, {0, 1, 0}, {1, 1, 1}, {0.1, 0, 3}};
  for (std::size_t i = 0; i < colours.size(); ++i) {
    lights.push_back(placed(reference::sphere(), {4.2 + 0.4 * double(i), 5.1, 5.3}, 4.0, colours[i], i == 3));
    const test::InjectRig rig(grid, lights);
    EXPECT_EQ(rig.palette.channels, (std::array{1, 1, 2, 3, 3})[i]);
    EXPECT_LE(error(grid, rig, 4.0), rig.roundingError() + 1e-6) << i + 1 << " lights";
  }
}

// A light that is the only one is divided as it goes in: the same bits, and as many touched cells, as beside a dark
// one. Broken by: no division there; a light's cells counted once per thread group.
TEST_F(InjectTest, TheOnlyLightIsTheSameBesideAnother) {
  const Grid grid = test::unitGrid({12, 12, 12});
  for (const MeshPtr& mesh : {reference::quad(), reference::sphere()}) {
    const EmittingLight light = placed(mesh, glm::dvec3(6.1, 5.3, 5.9), 5.0, {3.0, 2.0, 1.0});
    const test::InjectRig alone(grid, {light}),
        beside(grid, {light, placed(mesh, glm::dvec3(90, 0, 0), 5.0, {3.0, 2.0, 1.0})});
    EXPECT_EQ(test::fieldOf(alone.field.injected, alone.field, alone.palette).cells,
              test::fieldOf(beside.field.injected, beside.field, beside.palette).cells);
    EXPECT_EQ(alone.touched(), beside.touched());
    EXPECT_EQ(alone.touched(), test::voxelsOf(*alone.voxels[0]).size());
  }
}

// What moved away leaves nothing behind. Broken by: no retire pass; accumulators not left at zero.
TEST_F(InjectTest, CellsThatAreLeftGoDark) {
  const Grid grid = test::unitGrid({12, 12, 12});
  test::InjectRig rig(grid, {placed(reference::sphere(), {3.0, 3.0, 3.0}, 3.0, glm::dvec3(1.0))});
  for (const glm::dvec3 at : {glm::dvec3(8, 8, 8), glm::dvec3(8.4, 8, 8), glm::dvec3(90, 0, 0), glm::dvec3(4, 8, 4)}) {
    rig.lights[0] = placed(reference::sphere(), at, 3.0, glm::dvec3(1.0));
    rig.run();
    EXPECT_LE(error(grid, rig, 1.0), rig.roundingError() + 1e-6) << at.x;
    EXPECT_THAT(test::read<std::uint32_t>(rig.field.accumulators), testing::Each(0));
  }
}

// Triangles of no area are skipped and counted, also when two corners are one.
TEST_F(InjectTest, TrianglesWithoutAreaAreCounted) {
  const MeshPtr mesh = test::meshOf(
      {{{{1, 1, 1}, {1, 1, 1}, {2, 2, 2}}}, {{{1, 1, 1}, {2, 2, 2}, {3, 3, 3}}}, {{{1, 1, 1}, {2, 1, 1}, {1, 2, 1}}}});
  const test::InjectRig rig(test::unitGrid({4, 4, 4}), {test::lightOf(mesh, glm::dvec3(1.0))});
  EXPECT_EQ(test::read<layout::Counters>(rig.field.counters)[0].degenerate, 2U);
}

// The guard at its limit (MATHS.md 6.11): as many aligned lobes in one cell as the shift was chosen for. Their sum must
// be exact; with one bit more it overflows and comes out negative. Broken by: a shift one larger in fixedPointFor;
// one triangle more than kSetTriangles in keepsSets().
TEST_F(InjectTest, AccumulatorsHoldTheLargestSumThereCanBe) {
  for (const int count : {32, 33, 2048, 2049, 33446}) {
    const std::array<glm::vec3, 3> triangle = {glm::vec3(0.2F, 0.2F, 0.5F), glm::vec3(0.8F, 0.2F, 0.5F),
                                               glm::vec3(0.2F, 0.8F, 0.5F)};
    const test::InjectRig rig(
        test::unitGrid({1, 1, 1}),
        {test::lightOf(test::meshOf(std::vector(std::size_t(count), triangle)), glm::dvec3(1.0))});
    const reference::Coefficients got = test::fieldOf(rig.field.injected, rig.field, rig.palette).cells[0][0];
    EXPECT_NEAR(got.x, sh::kLobe0, sh::kLobe1 * rig.roundingError() + 1e-7) << count;
    EXPECT_NEAR(got.z, sh::kLobe1, sh::kLobe1 * rig.roundingError() + 1e-7) << count;
  }
}

}  // namespace
}  // namespace lpv
