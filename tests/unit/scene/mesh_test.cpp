// What a mesh from anywhere must be before it is one, and what is repaired instead of refused.
#include "scene/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "reference/emitter.h"
#include "reference/meshes.h"
#include "reference/sh.h"

namespace lpv {
namespace {

using testing::HasSubstr;

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

/// A tent: two triangles that share the edge 0-1, normals (0,0,1) and (1,0,1)/sqrt 2 before weighting.
Mesh tent() {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {2, 0, -2}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 1}};
  return mesh;
}

void expectRefused(Mesh mesh, const std::string& field, const std::string& words) {
  const Status status = finishMesh(mesh);
  EXPECT_EQ(status.code(), Code::kInvalidArgument);
  EXPECT_EQ(status.field(), field);
  EXPECT_THAT(status.message(), HasSubstr(words));
}

TEST(FinishMesh, FillsTheBounds) {
  Mesh mesh = tent();
  ASSERT_TRUE(finishMesh(mesh).ok());
  EXPECT_EQ(mesh.bounds.min, glm::dvec3(-1, 0, -2));
  EXPECT_EQ(mesh.bounds.max, glm::dvec3(2, 1, 0));
  mesh.positions[3] = {0, 0, -2};
  ASSERT_TRUE(finishMesh(mesh).ok());  // again: nothing of the old bounds stays
  EXPECT_EQ(mesh.bounds.max, glm::dvec3(0, 1, 0));
}

TEST(FinishMesh, RefusesAnEmptyMesh) {
  expectRefused(Mesh(), "positions", "at least 3");
  Mesh noTriangles = tent();
  noTriangles.triangles.clear();
  expectRefused(noTriangles, "indices", "at least 1");
}

TEST(FinishMesh, RefusesVerticesThatAreNotFiniteByIndexAndValue) {
  for (const float bad : {kNaN, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      Mesh mesh = tent();
      mesh.positions[2][axis] = bad;
      expectRefused(mesh, "positions", "positions[2]");
    }
  }
  Mesh far = tent();
  far.positions[1].y = 3e9F;
  expectRefused(far, "positions", "positions[1]");
}

TEST(FinishMesh, RefusesIndicesOutOfRange) {
  Mesh mesh = tent();
  mesh.triangles[1].y = 4;
  expectRefused(mesh, "indices", "vertex 4");
  mesh.triangles[1].y = 0xffffffffU;
  expectRefused(mesh, "indices", "4294967295");
}

TEST(FinishMesh, RefusesAttributesOfAnotherCount) {
  Mesh mesh = tent();
  mesh.normals.resize(3, {0, 0, 1});
  expectRefused(mesh, "normals", "3 entries for 4");
  mesh = tent();
  mesh.uvs.resize(5);
  expectRefused(mesh, "uvs", "5 entries for 4");
  mesh = tent();
  mesh.directions.resize(1, {0, 0, 1});
  expectRefused(mesh, "directions", "1 entries for 4");
}

TEST(FinishMesh, RefusesTextureCoordinatesAndDirectionsThatAreNotFinite) {
  Mesh mesh = tent();
  mesh.uvs.resize(4);
  mesh.uvs[3].y = kNaN;
  expectRefused(mesh, "uvs", "uvs[3]");
  mesh = tent();
  mesh.directions.resize(4, {0, 0, 1});
  mesh.directions[0].x = kInfinity;
  expectRefused(mesh, "directions", "directions[0]");
}

// Red when bad normals are refused, kept, or replaced by a constant.
TEST(FinishMesh, ReplacesNormalsThatAreNoneAndKeepsTheOthers) {
  Mesh mesh = tent();
  mesh.normals = {{kNaN, 0, 0}, {0, 0, 0}, {0, 0, 2}, {1, 0, kInfinity}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  const std::vector<glm::vec3> expected = vertexNormals(mesh.positions, mesh.triangles);
  EXPECT_EQ(mesh.normals[0], expected[0]);
  EXPECT_EQ(mesh.normals[1], expected[1]);
  EXPECT_EQ(mesh.normals[2], glm::vec3(0, 0, 1));  // only brought to unit length
  EXPECT_EQ(mesh.normals[3], expected[3]);
}

// Red when every normal is divided by its length: one in two is another then.
TEST(FinishMesh, FindsAFinishedMeshFinished) {
  for (int i = 0; i < 1000; ++i) {
    Mesh mesh = tent();
    for (int v = 0; v < 4; ++v) {
      mesh.normals.push_back(glm::vec3(std::sin(float(i + v)), std::cos(3.0F * float(i)), 0.1F * float(v + 1)));
    }
    ASSERT_TRUE(finishMesh(mesh).ok());
    Mesh again = mesh;
    ASSERT_TRUE(finishMesh(again).ok());
    ASSERT_EQ(again.normals, mesh.normals) << i;
  }
}

TEST(VertexNormals, AreWeightedByArea) {
  const Mesh mesh = tent();
  const std::vector<glm::vec3> normals = vertexNormals(mesh.positions, mesh.triangles);
  // Twice the areas as vectors: (0,0,1) and (2,0,2). Their sum, not the sum of units, points the way.
  const glm::dvec3 shared = glm::normalize(glm::dvec3(2, 0, 3));
  for (const std::size_t i : {0U, 1U}) EXPECT_NEAR(glm::distance(glm::dvec3(normals[i]), shared), 0.0, 1e-7);
  EXPECT_EQ(normals[2], glm::vec3(0, 0, 1));
  EXPECT_NEAR(glm::distance(glm::dvec3(normals[3]), glm::normalize(glm::dvec3(1, 0, 1))), 0.0, 1e-7);
}

TEST(VertexNormals, OfNothingPointAlongZ) {
  const std::vector<glm::vec3> points = {{1, 1, 1}, {1, 1, 1}, {1, 1, 1}, {0, 0, 0}};
  for (const glm::vec3& n : vertexNormals(points, {{0, 1, 2}})) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(VertexNormals, OfTinyTrianglesAreUnitVectors) {
  std::vector<glm::vec3> points = tent().positions;
  for (glm::vec3& p : points) p *= 1e-9F;
  for (const glm::vec3& n : vertexNormals(points, tent().triangles)) EXPECT_NEAR(glm::length(n), 1.0F, 1e-6F);
}

TEST(WithVertices, KeepsTrianglesAndRecomputesNormalsAndBounds) {
  Mesh mesh = *reference::sphere();
  std::vector<glm::vec3> moved = mesh.positions;
  for (glm::vec3& p : moved) p = p * 2.0F + glm::vec3(1, 0, 0);
  const Expected<Mesh> deformed = withVertices(mesh, moved, {});
  ASSERT_TRUE(deformed.ok()) << deformed.status().message();
  EXPECT_EQ(deformed->triangles, mesh.triangles);
  EXPECT_EQ(deformed->positions, moved);
  EXPECT_EQ(deformed->normals.size(), moved.size());
  EXPECT_NEAR(deformed->bounds.max.x, 2.0, 1e-6);
  EXPECT_DOUBLE_EQ(deformed->area, worldArea(*deformed, Transform())) << "what ticks are predicted from";
  const Expected<Mesh> plain = withVertices(*reference::pyramid(), reference::pyramid()->positions, {});
  ASSERT_TRUE(plain.ok());
  EXPECT_TRUE(plain->normals.empty());  // none before, none after
}

TEST(WithVertices, RefusesOtherCountsAndBadVertices) {
  const Mesh mesh = tent();
  EXPECT_EQ(withVertices(mesh, {{0, 0, 0}}, {}).status().field(), "positions");
  std::vector<glm::vec3> bad = mesh.positions;
  bad[3].z = kNaN;
  EXPECT_THAT(withVertices(mesh, bad, {}).status().message(), HasSubstr("positions[3]"));
  EXPECT_EQ(withVertices(mesh, mesh.positions, {{0, 0, 1}}).status().field(), "normals");
}

TEST(WorldArea, FollowsTheTransform) {
  Transform t;
  t.scale = {2.0, -3.0, 5.0};
  t.rotation = rotationFromEulerDegrees({10, 20, 30});
  t.translation = {1e6, 0, 0};
  EXPECT_NEAR(worldArea(*reference::quad(), t), 6.0, 1e-12);
  t.scale = glm::dvec3(2.0);
  EXPECT_NEAR(worldArea(*reference::sphere(), t) / worldArea(*reference::sphere(), Transform()), 4.0, 1e-12);
}

TEST(Mesh, CountsItsBytes) {
  const MeshPtr quad = reference::quad();
  EXPECT_EQ(quad->bytes(), 4 * (12U + 8U) + 2 * 12U);
}

}  // namespace
}  // namespace lpv
