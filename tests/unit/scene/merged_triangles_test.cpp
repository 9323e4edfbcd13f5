// Where the triangles of a mesh went when its flat patches were merged.
#include "scene/merged_triangles.h"

#include <gtest/gtest.h>

#include <memory>

#include "reference/meshes.h"

namespace lpv {
namespace {

/// A square of n x n quads beside a ball: one is merged, the other is not.
Mesh squareAndBall(unsigned n) {
  Mesh mesh = *reference::sphereOf(12, 6);
  Mesh out;
  out.positions = mesh.positions;
  out.triangles = mesh.triangles;
  const auto first = unsigned(out.positions.size());
  for (unsigned y = 0; y <= n; ++y) {
    for (unsigned x = 0; x <= n; ++x)
      out.positions.emplace_back(2.0F + float(x) / float(n), float(y) / float(n), 0.25F);
  }
  for (unsigned i = 0; i < n * n; ++i) {
    const unsigned at = first + i / n * (n + 1) + i % n;
    out.triangles.emplace_back(at, at + 1, at + n + 2);
    out.triangles.emplace_back(at, at + n + 2, at + n + 1);
  }
  EXPECT_TRUE(finishMesh(out).ok());
  return out;
}

// Triangles along a fan's border have their middle on one side: 16 of .002 m^2 at the most.
// Broken by: the first of a fan for all of it (.5).
TEST(MergedTriangles, HaveTheirTrianglesMiddles) {
  const Mesh mesh = squareAndBall(16);
  ASSERT_LT(mesh.merged.size(), mesh.triangles.size() / 2);
  const std::vector<std::uint32_t> of = mergedTriangleOf(mesh);
  ASSERT_EQ(of.size(), mesh.triangles.size());
  std::vector<double> areas(mesh.merged.size());
  const auto areaOf = [&](const glm::uvec3& t) {
    return 0.5 * double(glm::length(
                     glm::cross(mesh.positions[t.y] - mesh.positions[t.x], mesh.positions[t.z] - mesh.positions[t.x])));
  };
  for (std::size_t i = 0; i < of.size(); ++i) areas[of[i]] += areaOf(mesh.triangles[i]);
  for (std::size_t i = 0; i < areas.size(); ++i) EXPECT_NEAR(areas[i], areaOf(mesh.merged[i]), 0.04) << i;
}

TEST(MergedTriangles, AreTheirOwnWhereNothingWasMerged) {
  const MeshPtr ball = reference::sphereOf(12, 6);
  ASSERT_TRUE(ball->merged.empty());
  const std::vector<std::uint32_t> of = mergedTriangleOf(*ball);
  for (std::uint32_t i = 0; i < of.size(); ++i) EXPECT_EQ(of[i], i);
}

}  // namespace
}  // namespace lpv
