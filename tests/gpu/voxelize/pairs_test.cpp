// The GPU's set of (triangle, cell) pairs = the exact integer oracle's (MATHS.md 6.8). Together at least 10^7
// decisions; pairs_long_test.cpp has 10^9.
//
// Broken by, in voxelize/pairs.glsl: `<=` in overlap() (touching counts), or the third corner's normal left out of
// besideX; reachOf() without the least reach of 1 (an axis that says nothing decides); 0.001 for 0.501 in
// depthsInColumn(), or `lowest` always its first candidate; depth asked of a triangle in one layer; columns rounded
// inwards, or a kColumnMargin below 0; a snap in float (only a hair before and after the snap); cellRange() without the
// grid's outer upper face; no cell for a triangle that degenerates by snapping.

#include <cmath>
#include <random>

#include "gpu/voxelize/pair_families.h"

namespace lpv {
namespace {

using test::randomTriangles;
using test::Triangle;

class PairsTest : public test::GlTest {
 public:
  static void TearDownTestSuite() {
    RecordProperty("decisions", std::to_string(seen_.decisions));
    RecordProperty("pairs", std::to_string(seen_.pairs));
    rig_.reset();
  }

 protected:
  static void expectSamePairs(const std::vector<Triangle>& triangles, const glm::ivec3& dims,
                              const glm::dmat4& gridFromObject = glm::dmat4(1.0)) {
    if (!rig_) rig_ = std::make_unique<test::PairRig>();
    const test::PairVerdict verdict = rig_->compare(triangles, dims, gridFromObject);
    EXPECT_GT(verdict.pairs, 0U);
    EXPECT_EQ(verdict.missing, 0U) << "of " << verdict.pairs;
    EXPECT_EQ(verdict.extra, 0U) << "beside " << verdict.pairs;
    seen_ += verdict;
  }

  inline static test::PairVerdict seen_;
  inline static std::unique_ptr<test::PairRig> rig_;
};

// Long and flat grids, and one of a single layer.
TEST_F(PairsTest, TenMillionDecisions) {
  if (!rig_) rig_ = std::make_unique<test::PairRig>();
  const test::PairVerdict verdict = test::compareFamilies(*rig_, 10'000'000, {{1, 40, 3}, {33, 7, 18}, {16, 16, 16}});
  seen_ += verdict;
  EXPECT_GE(verdict.decisions, 10'000'000U);
}

TEST_F(PairsTest, SmallTriangles) {
  expectSamePairs(randomTriangles(20000, {16, 16, 16}, 0.7F, 0.0F, 1), {16, 16, 16});
}
TEST_F(PairsTest, MiddlingTrianglesInALongGrid) {
  expectSamePairs(randomTriangles(4000, {33, 7, 18}, 4.0F, 0.0F, 2), {33, 7, 18});
}
TEST_F(PairsTest, LargeTrianglesAreSplitIntoWorkItems) {
  expectSamePairs(randomTriangles(300, {40, 40, 40}, 50.0F, 0.0F, 3), {40, 40, 40});
}
TEST_F(PairsTest, TrianglesBiggerThanTheGrid) {
  expectSamePairs(randomTriangles(500, {12, 12, 12}, 40.0F, 0.0F, 4), {12, 12, 12});
}
TEST_F(PairsTest, CornersOnCellCorners) {
  expectSamePairs(randomTriangles(6000, {10, 10, 10}, 6.0F, 1.0F, 5), {10, 10, 10});
}
TEST_F(PairsTest, CornersOnHalfCells) { expectSamePairs(randomTriangles(6000, {10, 9, 8}, 5.0F, 0.5F, 6), {10, 9, 8}); }
TEST_F(PairsTest, OneCellGrid) { expectSamePairs(randomTriangles(5000, {1, 1, 1}, 2.0F, 0.125F, 7), {1, 1, 1}); }

// Far smaller than the lattice: segments and points after the snap go to their centroid's cell.
TEST_F(PairsTest, TinyTrianglesDegenerateBySnapping) {
  for (const float size : {0.02F, 0.003F, 1e-5F})
    expectSamePairs(randomTriangles(5000, {8, 8, 8}, size, 0.0F, std::uint32_t(1.0F / size)), {8, 8, 8});
}

TEST_F(PairsTest, Slivers) {
  std::mt19937 random(9);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  for (const float width : {1e-1F, 1e-2F, 1e-3F, 1e-5F, 1e-7F}) {
    std::vector<Triangle> triangles = randomTriangles(800, {16, 16, 16}, 12.0F, 0.0F, 10);
    for (Triangle& t : triangles)
      t[2] =
          glm::mix(t[0], t[1], uniform(random)) + width * glm::vec3(uniform(random), uniform(random), uniform(random));
    expectSamePairs(triangles, {16, 16, 16});
  }
}

/// Triangles within axis-aligned planes through cell faces (layer 0: outer lower, dims: outer upper) and beside them.
TEST_F(PairsTest, FacePlanesBelongToOneSide) {
  for (int axis = 0; axis < 3; ++axis) {
    for (const float offset : {0.0F, 1.0F / 256.0F, -1.0F / 256.0F, 0.5F}) {
      std::vector<Triangle> triangles = randomTriangles(600, {6, 6, 6}, 5.0F, 0.25F, 11);
      for (std::size_t i = 0; i < triangles.size(); ++i) {
        for (glm::vec3& p : triangles[i]) p[axis] = float(int(i % 8)) - 1.0F + offset;
      }
      expectSamePairs(triangles, {6, 6, 6});
    }
  }
}

// x + y + z = k through cell corners: four cells of a column touch, and slope-2 planes meet three.
TEST_F(PairsTest, DiagonalAndSlopeTwoPlanes) {
  std::vector<Triangle> triangles = randomTriangles(3000, {9, 9, 9}, 6.0F, 1.0F, 12);
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (glm::vec3& p : triangles[i]) p.z = i % 2 == 0 ? 12.0F - p.x - p.y : p.x + p.y - 4.0F;
  }
  expectSamePairs(triangles, {9, 9, 9});
}

// The tie of dominant axes: normals near (1, 1, 1).
TEST_F(PairsTest, NearlyEqualDominantAxes) {
  std::vector<Triangle> triangles = randomTriangles(3000, {9, 9, 9}, 4.0F, 1.0F / 256.0F, 13);
  std::mt19937 random(14);
  for (Triangle& t : triangles) {
    for (glm::vec3& p : t) p.z = 13.0F - p.x - p.y + float(int(random() % 3) - 1) / 256.0F;
  }
  expectSamePairs(triangles, {9, 9, 9});
}

// An object a million units away from its origin: composed in double, so nothing is lost but the vertices' own digits.
TEST_F(PairsTest, FarOrigins) {
  const glm::ivec3 dims(8, 8, 8);
  const glm::dvec3 far(1048576.0, -1048576.0, 524288.0);
  std::vector<Triangle> triangles = randomTriangles(3000, dims, 3.0F, 1.0F / 4.0F, 15);
  for (Triangle& t : triangles) {
    for (glm::vec3& p : t) p += glm::vec3(far);
  }
  glm::dmat4 gridFromObject(1.0);
  gridFromObject[3] = glm::dvec4(-far, 1.0);
  expectSamePairs(triangles, dims, gridFromObject);
}

// Corners halfway between lattice points, moved by less than a float can tell: which way they snap decides about cells.
TEST_F(PairsTest, AHairBeforeAndAfterTheSnap) {
  for (const double hair : {-1e-9, 0.0, 1e-9}) {
    std::vector<Triangle> triangles = randomTriangles(4000, {8, 8, 8}, 3.0F, 1.0F, 16);
    for (Triangle& t : triangles) {
      for (glm::vec3& p : t) p -= 1.0F / 512.0F;
    }
    glm::dmat4 gridFromObject(1.0);
    gridFromObject[3] = glm::dvec4(glm::dvec3(hair), 1.0);
    expectSamePairs(triangles, {8, 8, 8}, gridFromObject);
  }
}

}  // namespace
}  // namespace lpv
