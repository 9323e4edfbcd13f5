// The procedural meshes are what their names say: counts of the paper's Table 1, outward winding, closed where said.
#include "reference/meshes.h"

#include <gtest/gtest.h>

#include <map>
#include <utility>

#include "reference/sh.h"

namespace lpv::reference {
namespace {

double area(const Mesh& mesh) {
  double twice = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    twice += glm::length(glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a));
  }
  return 0.5 * twice;
}

/// Volume enclosed, positive when the winding is outward (divergence theorem).
double enclosed(const Mesh& mesh) {
  double six = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    six += glm::dot(glm::dvec3(mesh.positions[t.x]),
                    glm::cross(glm::dvec3(mesh.positions[t.y]), glm::dvec3(mesh.positions[t.z])));
  }
  return six / 6.0;
}

/// Every edge is used once in each direction, by position (seams may repeat vertices).
bool closed(const Mesh& mesh) {
  using Key = std::array<float, 3>;
  const auto key = [&](std::uint32_t i) { return Key{mesh.positions[i].x, mesh.positions[i].y, mesh.positions[i].z}; };
  std::map<std::pair<Key, Key>, int> edges;
  for (const glm::uvec3& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) ++edges[{key(t[k]), key(t[(k + 1) % 3])}];
  }
  for (const auto& [edge, count] : edges) {
    const auto back = edges.find({edge.second, edge.first});
    if (count != 1 || back == edges.end()) return false;
  }
  return true;
}

TEST(Meshes, HaveThePapersTriangleCounts) {
  EXPECT_EQ(quad()->triangles.size(), 2U);
  EXPECT_EQ(pyramid()->triangles.size(), 6U);
  EXPECT_EQ(tube()->triangles.size(), 12U);
  EXPECT_EQ(sphere()->triangles.size(), 720U);
}

TEST(Meshes, AreClosedAndOutwardWhereTheySaySo) {
  for (const MeshPtr& mesh : {pyramid(), sphere(), bumpySphere(100), bumpySphere(1234), bumpySphere(33446),
                              box(glm::dvec3(-1), glm::dvec3(1, 2, 3))}) {
    EXPECT_TRUE(closed(*mesh));
    EXPECT_GT(enclosed(*mesh), 0.0);
  }
  EXPECT_LT(enclosed(*box(glm::dvec3(-1), glm::dvec3(1), true)), 0.0);
  EXPECT_FALSE(closed(*tube()));
}

TEST(Meshes, HaveTheirSizes) {
  EXPECT_NEAR(area(*quadOf(20)), 1.0, 1e-6);
  EXPECT_NEAR(area(*pyramid()), 1.0 + 4.0 * 0.5 * std::sqrt(1.25), 1e-6);
  EXPECT_NEAR(area(*tube()), 6.0 * 0.1 * 2.0, 1e-6);
  EXPECT_NEAR(area(*sphere()) / pi(), 1.0, 0.02);  // 24 x 16 facets lie inside the sphere
  EXPECT_NEAR(area(*slivers(10, 1e-3)), 10 * 0.5e-3, 1e-6);
  EXPECT_EQ(bumpySphere(33446)->triangles.size(), 33446U);
}

TEST(Meshes, VertexNormalsPointOutward) {
  const MeshPtr ball = sphere();
  for (std::size_t i = 0; i < ball->positions.size(); ++i) {
    EXPECT_GT(glm::dot(ball->positions[i], ball->normals[i]), 0.49F);
  }
}

}  // namespace
}  // namespace lpv::reference
