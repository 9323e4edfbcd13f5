// The GPU's set of (triangle, cell) pairs = the exact integer oracle's (MATHS.md 6.8).
//
// Seen to fail when broken on purpose in pairs.glsl: `<=` in overlaps() (touching counts); a float instead of double
// snap; no upper face of the grid in cellRange(); 0.501 for 1.001 in depthRange(); the centroid of two corners; the
// edge axes of a face plane not left out.

#include "reference/pairs.h"

#include <cmath>
#include <random>
#include <set>

#include "gpu/buffer_texture.h"
#include "gpu/gl_test.h"
#include "gpu/stage_rig.h"

namespace lpv {
namespace {

using Triangle = std::array<glm::vec3, 3>;
using PairSet = std::set<std::pair<std::uint32_t, std::uint32_t>>;  // triangle, cell

class PairsTest : public test::GlTest {};

constexpr std::size_t kMostPairs = std::size_t(1) << 22;

gpu::Buffer paramsOf(const glm::ivec3& dims, std::uint32_t count, const glm::dmat4& gridFromObject) {
  layout::VoxelizeParams params{};
  params.gridFromObject = gridFromObject;
  params.areaFromObject = glm::dmat4(1.0);
  params.dims = glm::ivec4(dims, 0);
  params.triangles = glm::uvec4(0, count, 0, 0);
  return {"params", gpu::bytesOfValue(params)};
}

/// Both passes of voxelize.comp with pairs recorded instead of injected; triangles in batches of at most one piece.
PairSet gpuPairs(const std::vector<Triangle>& triangles, const glm::ivec3& dims, const glm::dmat4& gridFromObject,
                 bool& twice) {
  const gpu::Defines common = {
      {"LPV_FLUX", "0"}, {"LPV_TEXTURED", "0"}, {"LPV_DIRECTIONS", "0"}, {"LPV_RECORD_PAIRS", "1"}};
  gpu::Defines small = common, large = common;
  small.emplace_back("LPV_SMALL", "1");
  large.emplace_back("LPV_LARGE", "1");
  gpu::Program smallPass({"voxelize.comp"}, small), largePass({"voxelize.comp"}, large);
  const gpu::Buffer recorded("pairs", 8 + 8 * kMostPairs), cells("cells", 64);
  recorded.bindStorage(layout::kRecordedPairs);
  cells.bindStorage(layout::kVoxelCells);
  PairSet pairs;
  twice = false;
  for (std::size_t first = 0; first < triangles.size(); first += std::size_t(layout::kMaxPieceTriangles)) {
    const auto count = std::uint32_t(std::min(triangles.size() - first, std::size_t(layout::kMaxPieceTriangles)));
    std::vector<std::uint32_t> indices(count * 3);
    for (std::uint32_t i = 0; i < indices.size(); ++i) indices[i] = i;
    const gpu::Buffer positions("positions", std::as_bytes(std::span(triangles).subspan(first, count)));
    const gpu::Buffer order = test::bufferOf(indices), params = paramsOf(dims, count, gridFromObject);
    std::vector<std::uint32_t> list(std::size_t(layout::kListHeaderWords) + count * std::size_t(layout::kMaxSlices));
    list[1] = list[2] = 1;
    const gpu::Buffer items = test::bufferOf(list);
    const_cast<gpu::Buffer&>(recorded).fill(0);
    const gpu::BufferTexture positionTexels("positions", positions, gpu::BufferTexel::kVec3);
    const gpu::BufferTexture triangleTexels("triangles", order, gpu::BufferTexel::kUvec3);
    positionTexels.bind(layout::kPositions);
    triangleTexels.bind(layout::kTriangles);
    params.bindUniform(layout::kParams);
    items.bindStorage(layout::kLargeTriangles);
    items.bindAsDispatchArguments();
    smallPass.dispatch((count + 63) / 64);
    gpu::memoryBarrier();
    largePass.dispatchIndirect(0);
    gpu::memoryBarrier();
    const std::vector<std::uint32_t> words = test::read<std::uint32_t>(recorded);
    EXPECT_LE(words[0], kMostPairs);
    for (std::uint32_t i = 0; i < words[0]; ++i)
      twice |= !pairs.emplace(words[2 + 2 * i] + std::uint32_t(first), words[3 + 2 * i]).second;
  }
  return pairs;
}

PairSet oraclePairs(const std::vector<Triangle>& triangles, const glm::ivec3& dims, const glm::dmat4& gridFromObject) {
  const Grid grid = test::unitGrid(dims);
  PairSet pairs;
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Triangle& t = triangles[i];
    if (glm::cross(glm::dvec3(t[1]) - glm::dvec3(t[0]), glm::dvec3(t[2]) - glm::dvec3(t[0])) == glm::dvec3(0.0))
      continue;
    reference::SnappedTriangle snapped;
    for (std::size_t k = 0; k < 3; ++k)
      snapped.corners[k] = reference::snap(glm::dvec3(gridFromObject * glm::dvec4(glm::dvec3(t[k]), 1.0)));
    for (const glm::ivec3& cell : reference::cellsOf(snapped, dims)) pairs.emplace(i, std::uint32_t(grid.index(cell)));
  }
  return pairs;
}

void expectSamePairs(const std::vector<Triangle>& triangles, const glm::ivec3& dims,
                     const glm::dmat4& gridFromObject = glm::dmat4(1.0)) {
  bool twice = false;
  const PairSet gpu = gpuPairs(triangles, dims, gridFromObject, twice),
                oracle = oraclePairs(triangles, dims, gridFromObject);
  EXPECT_FALSE(twice) << "a pair was made twice";
  EXPECT_FALSE(oracle.empty());
  std::size_t missing = 0, extra = 0;
  for (const auto& pair : oracle) missing += gpu.contains(pair) ? 0 : 1;
  for (const auto& pair : gpu) extra += oracle.contains(pair) ? 0 : 1;
  EXPECT_EQ(missing, 0U) << "of " << oracle.size();
  EXPECT_EQ(extra, 0U) << "of " << gpu.size();
}

/// Triangles about `size` cells large, corners on multiples of `lattice` cells (0: anywhere), around a grid.
std::vector<Triangle> randomTriangles(int count, const glm::ivec3& dims, float size, float lattice,
                                      std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
  const auto point = [&] { return glm::vec3(uniform(random), uniform(random), uniform(random)); };
  std::vector<Triangle> out;
  for (int i = 0; i < count; ++i) {
    const glm::vec3 centre = (glm::vec3(dims) + 2.0F) * point() - 1.0F;
    Triangle t;
    for (glm::vec3& p : t) {
      p = centre + size * (point() - 0.5F);
      if (lattice > 0.0F) p = glm::round(p / lattice) * lattice;
    }
    out.push_back(t);
  }
  return out;
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
