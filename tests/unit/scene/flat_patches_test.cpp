// Flat patches as fans: the same surface, however it was cut up.

#include "scene/flat_patches.h"

#include <gtest/gtest.h>

#include <functional>

#include "reference/meshes.h"

namespace lpv {
namespace {

using Triangles = std::vector<glm::uvec3>;

/// Area times normal of some of a mesh's triangles.
glm::dvec3 areaNormal(const Mesh& mesh, const Triangles& triangles) {
  glm::dvec3 sum(0.0);
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 p(mesh.positions[t.x]);
    sum += 0.5 * glm::cross(glm::dvec3(mesh.positions[t.y]) - p, glm::dvec3(mesh.positions[t.z]) - p);
  }
  return sum;
}

/// A grid of squares over [0, n]^2, two triangles each, where `has` says so; vertices of their own when `soup`.
Mesh squares(int n, const std::function<bool(int, int)>& has, bool soup = false) {
  Mesh mesh;
  const auto vertex = [&](int x, int y) {
    if (!soup) return std::uint32_t(y * (n + 1) + x);
    mesh.positions.emplace_back(x, y, 0);
    return std::uint32_t(mesh.positions.size() - 1);
  };
  for (int y = 0; y <= n && !soup; ++y)
    for (int x = 0; x <= n; ++x) mesh.positions.emplace_back(x, y, 0);
  for (int y = 0; y < n; ++y) {
    for (int x = 0; x < n; ++x) {
      if (!has(x, y)) continue;
      const std::uint32_t a = vertex(x, y), b = vertex(x + 1, y), c = vertex(x + 1, y + 1), d = vertex(x, y + 1);
      mesh.triangles.emplace_back(a, b, c);
      mesh.triangles.emplace_back(a, c, d);
    }
  }
  EXPECT_TRUE(finishMesh(mesh).ok());
  return mesh;
}

const auto kAll = [](int, int) { return true; };

// Broken by: corners on a side kept; no repeated vertices joined.
TEST(FlatPatchesTest, AQuadIsTwoTrianglesFromTheSameCorners) {
  std::vector<std::vector<glm::vec2>> corners;
  for (const Mesh& mesh : {squares(4, kAll), squares(12, kAll), squares(12, kAll, true)}) {
    ASSERT_EQ(mesh.merged.size(), 2U);
    EXPECT_EQ(areaNormal(mesh, mesh.merged), areaNormal(mesh, mesh.triangles));
    std::vector<glm::vec2> places;
    for (const glm::uvec3& t : mesh.merged) {
      for (int k = 0; k < 3; ++k) places.push_back(glm::vec2(mesh.positions[t[k]]) / float(mesh.bounds.max.x));
    }
    corners.push_back(places);
  }
  EXPECT_EQ(corners[1], corners[0]);
  EXPECT_EQ(corners[2], corners[0]);
}

// Turned and moved before it was rounded to floats. Broken by: a plane through the first triangle.
TEST(FlatPatchesTest, RoundingDoesNotBend) {
  Mesh mesh = *reference::quadOf(100);
  const glm::dvec3 n = glm::normalize(glm::dvec3(1, 2, 3)), u = glm::normalize(glm::cross(n, glm::dvec3(1, 0, 0)));
  for (glm::vec3& p : mesh.positions)
    p = glm::vec3(double(p.x) * u + double(p.y) * glm::cross(n, u) + glm::dvec3(3, 1, 2));
  ASSERT_TRUE(finishMesh(mesh).ok());
  EXPECT_EQ(mesh.merged.size(), 2U);
}

// Broken by: an outline taken for convex; the first of several loops taken for all.
TEST(FlatPatchesTest, OtherOutlinesStay) {
  EXPECT_TRUE(squares(6, [](int x, int y) { return x < 3 || y < 3; }).merged.empty()) << "L";
  EXPECT_TRUE(squares(6, [](int x, int y) { return x != 3 || y != 3; }).merged.empty()) << "a hole";
  EXPECT_EQ(squares(6, [](int x, int y) { return (x < 3) == (y < 3); }).merged.size(), 4U)
      << "two squares that share a corner are two patches";
}

// Broken by: a tolerance of 1e-5 of the extent.
TEST(FlatPatchesTest, WhatBendsStays) {
  for (const MeshPtr& mesh : {reference::sphere(), reference::sphereOf(300, 200), reference::tube(), reference::quad(),
                              reference::bumpySphere(4000)}) {
    EXPECT_TRUE(mesh->merged.empty()) << mesh->triangles.size();
  }
}

// A closed box of many triangles, one of its corners bent out, and a triangle without area. Broken by: triangles of
// patches that stay left out.
TEST(FlatPatchesTest, TheRestOfAMeshIsKept) {
  Mesh mesh = squares(8, kAll);
  mesh.positions[0].z = 0.5F;
  mesh.triangles.emplace_back(3, 3, 4);
  ASSERT_TRUE(finishMesh(mesh).ok());
  const glm::dvec3 want = areaNormal(mesh, mesh.triangles), got = areaNormal(mesh, mesh.evenTriangles());
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(got[k], want[k], 1e-12);
  mesh.merged.clear();
  EXPECT_EQ(&mesh.evenTriangles(), &mesh.triangles);
}

TEST(FlatPatchesTest, ADeformedMeshIsLookedAtAgain) {
  const MeshPtr quad = reference::quadOf(10);
  std::vector<glm::vec3> bent = quad->positions;
  for (glm::vec3& p : bent) p.z = p.x * p.x;
  Expected<Mesh> mesh = withVertices(*quad, bent, {});
  ASSERT_TRUE(mesh.ok());
  EXPECT_TRUE(mesh->merged.size() > 2U || mesh->merged.empty());
  mesh = withVertices(*quad, quad->positions, {});
  EXPECT_EQ(mesh->merged, quad->merged);
}

}  // namespace
}  // namespace lpv
