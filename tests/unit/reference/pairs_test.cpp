// Two exact opinions about which (triangle, cell) pairs there are must never differ (MATHS.md 2; 6.2, 6.8).
#include "reference/pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "reference/clip_exact.h"
#include "reference/field.h"

namespace lpv::reference {
namespace {

using Points = std::array<LatticePoint, 3>;

SnappedTriangle triangle(const LatticePoint& a, const LatticePoint& b, const LatticePoint& c) {
  return {Points{a, b, c}};
}

/// Asks both oracles about every cell of the grid; counts decisions.
std::size_t expectAgreement(const SnappedTriangle& t, const glm::ivec3& dims) {
  const std::vector<glm::ivec3> cells = cellsOf(t, dims);
  std::size_t decisions = 0;
  forEachCell(dims, [&](const glm::ivec3& cell) {
    const bool pair = std::find(cells.begin(), cells.end(), cell) != cells.end();
    const bool area = clippedFraction(t, cell, dims) > 0.0;
    ++decisions;
    if (pair == area) return;
    const auto text = [](const LatticePoint& p) {
      return "(" + std::to_string(p.x) + "," + std::to_string(p.y) + "," + std::to_string(p.z) + ")";
    };
    ADD_FAILURE() << "cell " << cell.x << "," << cell.y << "," << cell.z << ": separating axes say " << pair
                  << ", clipping says " << area << " for " << text(t.corners[0]) << text(t.corners[1])
                  << text(t.corners[2]);
  });
  return decisions;
}

/// Lattice points of several kinds: anywhere, near cell faces, on cell corners.
class RandomPoints {
 public:
  RandomPoints(std::uint32_t seed, int cells) : random_(seed), units_(cells * kUnitsPerCell) {}

  LatticePoint anywhere(std::int64_t margin = 0) {
    std::uniform_int_distribution<std::int64_t> at(-margin, units_ + margin);
    return {at(random_), at(random_), at(random_)};
  }
  /// Each coordinate on a cell face, one unit beside it, or anywhere.
  LatticePoint awkward() {
    LatticePoint p = anywhere(kUnitsPerCell);
    std::uniform_int_distribution<int> kind(0, 5);
    for (int k = 0; k < 3; ++k) {
      const std::int64_t face = (p[k] / kUnitsPerCell) * kUnitsPerCell;
      const int choice = kind(random_);
      if (choice < 3) p[k] = face;
      if (choice == 3) p[k] = face + 1;
      if (choice == 4) p[k] = face - 1;
    }
    return p;
  }
  LatticePoint near(const LatticePoint& p, std::int64_t distance) {
    std::uniform_int_distribution<std::int64_t> by(-distance, distance);
    return p + LatticePoint(by(random_), by(random_), by(random_));
  }

 private:
  std::mt19937 random_;
  std::int64_t units_;
};

const glm::ivec3 kDims(5, 4, 6);

// Red when a comparison in overlapStrictly loses its strictness, when an axis is left out, or when the rule of the
// face plane or of the segment is changed in one of the two files.
TEST(PairOracles, AgreeOnRandomTriangles) {
  RandomPoints points(11, 6);
  std::size_t decisions = 0;
  for (int i = 0; i < 1200; ++i) {
    decisions += expectAgreement(triangle(points.anywhere(300), points.anywhere(300), points.anywhere(300)), kDims);
  }
  RecordProperty("decisions", int(decisions));
}

TEST(PairOracles, AgreeOnCornersOnFacesAndOneUnitBeside) {
  RandomPoints points(12, 5);
  for (int i = 0; i < 2500; ++i) {
    expectAgreement(triangle(points.awkward(), points.awkward(), points.awkward()), kDims);
  }
}

TEST(PairOracles, AgreeOnSliversSegmentsAndPoints) {
  RandomPoints points(13, 5);
  for (int i = 0; i < 1000; ++i) {
    const LatticePoint a = points.anywhere(100);
    const LatticePoint b = points.anywhere(100);
    expectAgreement(triangle(a, b, points.near(b, 1)), kDims);
    expectAgreement(triangle(a, b, (a + b) / std::int64_t(2)), kDims);
    expectAgreement(triangle(a, points.near(a, 2), points.near(a, 2)), kDims);
    expectAgreement(triangle(a, a, b), kDims);
    expectAgreement(triangle(a, a, a), kDims);
  }
}

// Along cell edges and faces, through corners, in any direction of few units.
TEST(PairOracles, AgreeOnSegmentsThroughFacesAndCorners) {
  RandomPoints points(19, 5);
  std::mt19937 random(20);
  std::uniform_int_distribution<std::int64_t> few(-4, 4);
  for (int i = 0; i < 3000; ++i) {
    const LatticePoint a = points.awkward();
    const LatticePoint step = std::int64_t(i % 2 == 0 ? 64 : 7) * LatticePoint(few(random), few(random), few(random));
    expectAgreement(triangle(a, a + few(random) * step, a + few(random) * step), kDims);
  }
}

TEST(PairOracles, AgreeInFacePlanesIncludingTheOuterOnes) {
  RandomPoints points(14, 5);
  for (int axis = 0; axis < 3; ++axis) {
    for (int layer = -1; layer <= kDims[axis] + 1; ++layer) {
      for (int i = 0; i < 40; ++i) {
        Points p = {points.awkward(), points.awkward(), points.anywhere(200)};
        for (LatticePoint& corner : p) corner[axis] = std::int64_t(layer) * kUnitsPerCell;
        expectAgreement({p}, kDims);
      }
    }
  }
}

// Planes x + y + z = const through lattice corners touch up to 4 cells of a column, and only 3 with area.
TEST(PairOracles, AgreeOnDiagonalPlanes) {
  RandomPoints points(15, 5);
  for (int k = 0; k <= 12; ++k) {
    for (int i = 0; i < 30; ++i) {
      Points p = {points.awkward(), points.awkward(), points.awkward()};
      for (LatticePoint& corner : p) corner.z = std::int64_t(k) * kUnitsPerCell - corner.x - corner.y;
      expectAgreement({p}, kDims);
    }
  }
}

TEST(PairOracles, AgreeOnTrianglesBiggerThanTheGridAndOutsideIt) {
  RandomPoints points(16, 5);
  for (int i = 0; i < 600; ++i) {
    expectAgreement(triangle(points.anywhere(20000), points.anywhere(20000), points.anywhere(20000)), kDims);
    const LatticePoint far = points.anywhere(0) + LatticePoint(3000, 0, 0);
    expectAgreement(triangle(far, points.near(far, 900), points.near(far, 900)), kDims);
  }
}

// The shares of a triangle that is wholly inside add up to 1: rounding of a few dozen terms is left.
TEST(ClippedFraction, ClosesToOneInside) {
  RandomPoints points(17, 4);
  for (int i = 0; i < 300; ++i) {
    const SnappedTriangle t = triangle(points.anywhere(), points.anywhere(), points.anywhere());
    double sum = 0.0;
    forEachCell(glm::ivec3(4), [&](const glm::ivec3& cell) { sum += clippedFraction(t, cell, glm::ivec3(4)); });
    EXPECT_NEAR(sum, 1.0, 1e-13);
  }
}

TEST(CellsOf, FacePlaneBelongsToTheUpperCellAndTheOuterOneToTheLast) {
  const glm::ivec3 dims(3, 3, 3);
  const auto inPlane = [](std::int64_t x) { return triangle({x, 10, 10}, {x, 200, 10}, {x, 10, 200}); };
  EXPECT_EQ(cellsOf(inPlane(256), dims), std::vector<glm::ivec3>({{1, 0, 0}}));
  EXPECT_EQ(cellsOf(inPlane(0), dims), std::vector<glm::ivec3>({{0, 0, 0}}));
  EXPECT_EQ(cellsOf(inPlane(768), dims), std::vector<glm::ivec3>({{2, 0, 0}}));
  EXPECT_TRUE(cellsOf(inPlane(769), dims).empty());
  EXPECT_TRUE(cellsOf(inPlane(1024), dims).empty());
  EXPECT_TRUE(cellsOf(inPlane(-1), dims).empty());
  EXPECT_EQ(cellsOf(inPlane(255), dims), std::vector<glm::ivec3>({{0, 0, 0}}));
}

TEST(CellsOf, TouchingAlongAnEdgeOrACornerIsNoPair) {
  const SnappedTriangle edgeOnFace = triangle({256, 20, 20}, {256, 200, 20}, {300, 100, 100});
  EXPECT_EQ(cellsOf(edgeOnFace, glm::ivec3(3)), std::vector<glm::ivec3>({{1, 0, 0}}));
  const SnappedTriangle cornerOnCorner = triangle({256, 256, 256}, {400, 300, 300}, {300, 400, 300});
  EXPECT_EQ(cellsOf(cornerOnCorner, glm::ivec3(3)), std::vector<glm::ivec3>({{1, 1, 1}}));
}

// Along a cell edge, across a corner, beside it, and points. Red when touching counts; when the half-open rule is left
// out for one axis; when the centroid's cell takes all.
TEST(CellsOf, WithoutAreaItIsTheCellsOfItsSegment) {
  using Cells = std::vector<glm::ivec3>;
  const glm::ivec3 dims(3, 3, 3);
  EXPECT_EQ(cellsOf(triangle({0, 256, 768}, {768, 256, 768}, {384, 256, 768}), dims),
            Cells({{0, 1, 2}, {1, 1, 2}, {2, 1, 2}}));
  EXPECT_EQ(cellsOf(triangle({512, 512, 10}, {0, 0, 10}, {0, 0, 10}), dims), Cells({{0, 0, 0}, {1, 1, 0}}));
  EXPECT_EQ(cellsOf(triangle({512, 513, 10}, {0, 1, 10}, {256, 257, 10}), dims),
            Cells({{0, 0, 0}, {0, 1, 0}, {1, 1, 0}, {1, 2, 0}}));
  EXPECT_EQ(cellsOf(triangle({-256, 5, 5}, {256, 5, 5}, {0, 5, 5}), dims), Cells({{0, 0, 0}}));
  EXPECT_EQ(cellsOf(triangle({768, 768, 768}, {768, 768, 768}, {768, 768, 768}), dims), Cells({{2, 2, 2}}));
  EXPECT_EQ(cellsOf(triangle({256, 255, 0}, {256, 255, 0}, {256, 255, 0}), dims), Cells({{1, 0, 0}}));
  EXPECT_TRUE(cellsOf(triangle({-1, 0, 0}, {-1, 0, 0}, {-1, 0, 0}), dims).empty());
  EXPECT_TRUE(cellsOf(triangle({-10, 769, 5}, {700, 769, 5}, {0, 769, 5}), dims).empty());
}

// A triangle's width grows from one end to the middle corner's place and falls from there: a quarter of the area lies
// in the first half of one that grows all the way.
TEST(ClippedFraction, ASegmentKeepsItsTrianglesArea) {
  const glm::ivec3 dims(4, 1, 1);
  EXPECT_DOUBLE_EQ(clippedFraction(triangle({0, 9, 9}, {512, 9, 9}, {512, 9, 9}), {0, 0, 0}, dims), 0.25);
  EXPECT_DOUBLE_EQ(clippedFraction(triangle({0, 9, 9}, {1024, 9, 9}, {512, 9, 9}), {1, 0, 0}, dims), 0.375);
  EXPECT_DOUBLE_EQ(clippedFraction(triangle({-256, 9, 9}, {256, 9, 9}, {0, 9, 9}), {0, 0, 0}, dims), 0.5);
  EXPECT_EQ(clippedFraction(triangle({256, 9, 9}, {256, 9, 9}, {256, 9, 9}), {1, 0, 0}, dims), 1.0);
  EXPECT_EQ(clippedFraction(triangle({256, 9, 9}, {256, 9, 9}, {256, 9, 9}), {0, 0, 0}, dims), 0.0);
}

TEST(CellsOf, ThreeCellsOfOneColumnOccur) {
  // MATHS.md 7: the paper's "maximum of 2" is false; slope 1 in both directions gives 3.
  const SnappedTriangle steep = triangle({0, 0, 200}, {512, 0, 712}, {0, 512, 712});
  std::size_t most = 0;
  for (int x = 0; x < 2; ++x) {
    std::set<int> depths;
    for (const glm::ivec3& c : cellsOf(steep, glm::ivec3(4))) {
      if (c.x == x && c.y == 0) depths.insert(c.z);
    }
    most = std::max(most, depths.size());
  }
  EXPECT_EQ(most, 3U);
}

TEST(CellsOf, VertexOrderDoesNotMatterAndAxesAreEqual) {
  RandomPoints points(18, 5);
  const glm::ivec3 cube(5);
  for (int i = 0; i < 400; ++i) {
    const Points p = {points.awkward(), points.awkward(), points.awkward()};
    const std::vector<glm::ivec3> cells = cellsOf({p}, cube);
    EXPECT_EQ(cells, cellsOf({Points{p[2], p[1], p[0]}}, cube));
    EXPECT_EQ(cells, cellsOf({Points{p[1], p[2], p[0]}}, cube));
    Points turned = p;
    for (LatticePoint& corner : turned) corner = {corner.y, corner.z, corner.x};
    std::vector<glm::ivec3> back;
    for (const glm::ivec3& c : cellsOf({turned}, cube)) back.emplace_back(c.z, c.x, c.y);
    const auto before = [&](const glm::ivec3& a, const glm::ivec3& b) {
      return std::array{a.z, a.y, a.x} < std::array{b.z, b.y, b.x};
    };
    std::sort(back.begin(), back.end(), before);
    EXPECT_EQ(cells, back);
  }
}

// 64-bit products hold to 2^19; a triangle beyond takes the 128-bit path. All these are the plane z = x + 300 within
// the grid, whatever their size. Red when the 64-bit path is used beyond its range: its products wrap.
TEST(CellsOf, BothIntegerWidthsAgreeUpToTheirLimits) {
  const auto slope = [](std::int64_t size) {
    return triangle({-size, -size, 300 - size}, {size, -size, 300 + size}, {0, size, 300});
  };
  const std::vector<glm::ivec3> cells = cellsOf(slope(5000), glm::ivec3(4));
  EXPECT_EQ(cells.size(), 4U * (2 + 2 + 1));  // layers 1-2, 2-3 and 3 (4 is outside) for x = 0, 1, 2
  for (const std::int64_t size : {(1LL << 19) - 300, (1LL << 19) + 1, 900000011LL, 7777777777LL}) {
    EXPECT_EQ(cellsOf(slope(size), glm::ivec3(4)), cells) << size;
  }
  EXPECT_EQ(cellsOf(slope(kMaxLattice - 300), glm::ivec3(4)), cells);
  EXPECT_THROW(cellsOf(slope(kMaxLattice), glm::ivec3(4)), std::out_of_range);
}

TEST(Snap, RoundsToTheNearestHalvesUp) {
  EXPECT_EQ(snap({1.0, 0.5, 2.25}), LatticePoint(256, 128, 576));
  const double half = 0.5 / kUnitsPerCell;
  EXPECT_EQ(snap({half, -half, 3 * half}), LatticePoint(1, 0, 2));
  EXPECT_EQ(snap({half - 1e-12, -half - 1e-12, -1e-9}), LatticePoint(0, -1, 0));
}

TEST(Snap, SurvivesAnOriginAMillionMetresAway) {
  Grid grid;
  grid.origin = glm::dvec3(1e6, -1e6, 1e6);
  grid.cell = 0.5;
  grid.dims = glm::ivec3(8);
  glm::dmat4 world(1.0);
  world[3] = glm::dvec4(1e6 + 1.0, -1e6 + 1.0, 1e6 + 1.0, 1.0);
  EXPECT_EQ(snap(grid, world, glm::vec3(0.25F, 0.0F, -0.25F)), LatticePoint(640, 512, 384));
}

TEST(PairsOf, ListsByTriangleThenByCell) {
  const SnappedTriangle small = triangle({10, 10, 10}, {20, 10, 10}, {10, 20, 10});
  const SnappedTriangle wide = triangle({10, 10, 10}, {500, 10, 20}, {10, 20, 30});
  const std::vector<Pair> expected = {{0, {0, 0, 0}}, {1, {0, 0, 0}}, {1, {1, 0, 0}}};
  EXPECT_EQ(pairsOf({small, wide}, glm::ivec3(2)), expected);
}

}  // namespace
}  // namespace lpv::reference
