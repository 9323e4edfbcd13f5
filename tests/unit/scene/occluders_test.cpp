// The BVH over BVHs against a look at every triangle.
#include "scene/occluders.h"

#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <random>
#include <thread>

#include "reference/meshes.h"
#include "reference/occlusion.h"
#include "reference/room.h"
#include "scene/shadowing.h"
#include "shaders/layout.h"

namespace lpv {
namespace {

using reference::Meeting;
using reference::Segment;

/// Triangles of sizes from .01 to 1 m with corners within a few metres of the origin.
MeshPtr soup(std::size_t triangles, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::normal_distribution<float> normal;
  const auto vector = [&](float scale) {
    const float x = normal(random), y = normal(random);
    return scale * glm::vec3(x, y, normal(random));
  };
  Mesh mesh;
  for (std::uint32_t i = 0; i < triangles; ++i) {
    const glm::vec3 at = vector(1.0F);
    const float size = std::pow(10.0F, -1.0F + 0.5F * std::min(2.0F, std::abs(normal(random))));
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(at + vector(size));
    mesh.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  EXPECT_TRUE(finishMesh(mesh).ok());
  return std::make_shared<Mesh>(std::move(mesh));
}

Transform pose(const glm::dvec3& at, const glm::dvec3& scale, double angle) {
  return {at, glm::angleAxis(angle, glm::normalize(glm::dvec3(1, 2, 3))), scale};
}

void addSurface(Scene& scene, const MeshPtr& mesh, const Transform& transform) {
  auto surface = std::make_shared<Surface>();
  surface->name = "surface " + std::to_string(scene.surfaces.size());
  surface->mesh = mesh;
  surface->transform = transform;
  scene.surfaces[surface->name] = surface;
}

void addLight(Scene& scene, const std::string& name, const MeshPtr& mesh, const Transform& transform = {}) {
  auto light = std::make_shared<Light>();
  light->name = name;
  light->mesh = mesh;
  light->transform = transform;
  scene.lights[name] = light;
}

Scene sceneOf(const MeshPtr& mesh, const Transform& transform = {}) {
  Scene scene;
  addSurface(scene, mesh, transform);
  return scene;
}

/// Answers that differ from the look at all triangles, of those that it is clear about; at most 1 % are unclear, and
/// both answers are given often.
std::size_t differences(const Scene& scene, const std::vector<Segment>& segments, int light) {
  const Occluders occluders(scene);
  const reference::Occlusion truth(occludersOf(scene));
  std::size_t different = 0, unclear = 0, blocked = 0;
  for (const Segment& s : segments) {
    const Meeting want = truth.meeting(s, light, 1e-5);
    unclear += std::size_t(want == Meeting::kUnclear);
    blocked += std::size_t(want == Meeting::kSome);
    if (want != Meeting::kUnclear)
      different += std::size_t(occluders.blocked(s.from, s.to, light) != (want == Meeting::kSome));
  }
  EXPECT_LE(unclear, segments.size() / 100);
  EXPECT_GE(blocked, segments.size() / 20);
  EXPECT_LE(blocked, segments.size() - segments.size() / 20);
  return different;
}

void expectBlocked(const Scene& scene, const std::vector<Segment>& segments, const std::string& what) {
  const Occluders occluders(scene);
  std::size_t open = 0;
  for (const Segment& s : segments) open += std::size_t(!occluders.blocked(s.from, s.to, kAllLights));
  EXPECT_EQ(open, 0U) << what << ", of " << segments.size();
}

TEST(Occluders, AnswerAsAllTrianglesDo) {
  for (const auto& [triangles, reach] : {std::pair(1UL, 0.3), {4UL, 0.4}, {5UL, 0.5}, {100UL, 1.0}, {2000UL, 0.4}}) {
    const Scene scene = sceneOf(soup(triangles, std::uint32_t(triangles)));
    const glm::vec3* corners = scene.surfaces.begin()->second->mesh->positions.data();
    const glm::dvec3 middle((corners[0] + corners[1] + corners[2]) / 3.0F);
    EXPECT_EQ(differences(scene, reference::randomSegments(3000, middle - reach, middle + reach, 3), kAllLights), 0U)
        << triangles;
  }
}

TEST(Occluders, AnswerAsAllTrianglesDoForScaledTurnedAndMirroredMeshes) {
  Scene scene;
  const MeshPtr mesh = soup(60, 1);
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.5 * i;
    const glm::dvec3 scale(i % 2 == 0 ? 0.4 : -0.4, 0.1 + 0.05 * i, i % 3 == 0 ? -0.3 : 0.3);
    addSurface(scene, i % 4 == 0 ? reference::sphere() : mesh,
               pose({std::cos(angle), std::sin(angle), 0.1 * i}, scale, angle));
  }
  EXPECT_EQ(differences(scene, reference::randomSegments(5000, glm::dvec3(-2), glm::dvec3(2), 4), kAllLights), 0U);
}

// Red where the box of a wall, in floats, is beside the wall.
TEST(Occluders, AnswerFarFromTheOrigin) {
  const glm::dvec3 wall(5e4, -2e4, 70000.001);
  const Occluders flat(sceneOf(reference::quad(), {wall, {1, 0, 0, 0}, glm::dvec3(1)}));
  for (const double z : {-0.0005, 0.0005}) {
    const glm::dvec3 from = wall + glm::dvec3(0.1, 0.1, z);
    EXPECT_TRUE(flat.blocked(from, from - glm::dvec3(0, 0, 1000 * z), kAllLights)) << z;
    EXPECT_FALSE(flat.blocked(from, from + glm::dvec3(0, 0, 1000 * z), kAllLights)) << z;
  }
  const glm::dvec3 at(5e4, -2e4, 7e4);
  const Scene scene = sceneOf(soup(500, 2), pose(at, glm::dvec3(1, 2, 1), 1.0));
  EXPECT_EQ(differences(scene, reference::randomSegments(3000, at - 2.0, at + 2.0, 5), kAllLights), 0U);
}

// Red where an edge belongs to neither of its triangles.
TEST(Occluders, LetNothingThroughWhereTrianglesShareAnEdge) {
  const std::vector<std::pair<std::string, MeshPtr>> meshes = {
      {"box", reference::box(glm::dvec3(-0.5), glm::dvec3(0.5))},
      {"sphere", reference::sphere()},
      {"fine sphere", reference::sphereOf(400, 201, false)},
      {"bumpy sphere", reference::bumpySphere(20000)}};
  for (const auto& [name, mesh] : meshes) {
    for (const Transform& t :
         {Transform(), pose({1, 2, 3}, {2, -0.1, 0.7}, 0.8), pose({300, 1, 2}, glm::dvec3(1), 0)}) {
      const Scene scene = sceneOf(mesh, t);
      const auto occluder = occludersOf(scene)[0];
      for (const glm::dvec3& start : {glm::dvec3(0), glm::dvec3(0.1, 0.05, -0.03)}) {
        const glm::dvec3 from(occluder.worldFromObject * glm::dvec4(start, 1.0));
        expectBlocked(scene, reference::segmentsThroughEdges(occluder, from, 3000), name);
      }
    }
  }
}

// Segments that lie in faces of boxes, and in edges.
TEST(Occluders, LetNothingThroughAlongAxesAndEdges) {
  constexpr int kCuts = 16;
  std::vector<Segment> segments;
  for (int i = 1; i < kCuts; ++i) {
    for (int k = 1; k < 2 * kCuts; ++k) {
      const double x = double(i) / kCuts - 0.5, y = double(k) / (2 * kCuts) - 0.5;
      segments.push_back({{x, y, -1}, {x, y, 1}});
      segments.push_back({{y, x, 1}, {y, x, -1}});
    }
  }
  expectBlocked(sceneOf(reference::quadOf(kCuts)), segments, "square");
}

// Floors that are askew in their meshes, so that their boxes say nothing.
TEST(Occluders, LeaveOpenWhatStartsJustAboveAFloor) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> share(-0.45, 0.45);
  for (const int cuts : {1, 60}) {
    const Scene scene = sceneOf(reference::turned(reference::quadOf(cuts), 0.8), pose({3, 4, 5}, glm::dvec3(7), 1.1));
    const Occluders occluders(scene);
    const glm::dmat4 m = scene.surfaces.begin()->second->transform.worldFromObject() * reference::turn(0.8);
    for (int i = 0; i < 3000; ++i) {
      const double x = share(random), y = share(random), up = 1e-6 + (i % 3) * (0.5 + share(random));
      const glm::dvec3 from(m * glm::dvec4(share(random), share(random), 1e-6, 1.0)), to(m * glm::dvec4(x, y, up, 1.0));
      ASSERT_FALSE(occluders.blocked(from, to, kAllLights)) << cuts << ", " << i;
      ASSERT_FALSE(occluders.blocked(to, from, kAllLights)) << cuts << ", " << i;
    }
  }
}

TEST(Occluders, MeetWhatLiesBetweenTheEndsOnly) {
  const Scene scene = sceneOf(reference::quad());
  const Occluders occluders(scene);
  EXPECT_TRUE(occluders.blocked({0.1, 0.2, 1}, {0.1, 0.2, -1}, kAllLights));
  EXPECT_TRUE(occluders.blocked({0.1, 0.2, -1}, {0.1, 0.2, 1}, kAllLights));  // either side
  EXPECT_FALSE(occluders.blocked({0.1, 0.2, 1}, {0.1, 0.2, 1e-6}, kAllLights));
  EXPECT_FALSE(occluders.blocked({0.1, 0.2, -1e-6}, {0.1, 0.2, -1}, kAllLights));
  EXPECT_FALSE(occluders.blocked({0.1, 0.2, 1}, {0.1, 0.2, 0}, kAllLights));  // ends on it
  EXPECT_FALSE(occluders.blocked({0.6, 0.2, 1}, {0.6, 0.2, -1}, kAllLights));
  EXPECT_FALSE(occluders.blocked({0.1, 0.2, 1}, {0.1, 0.2, 1}, kAllLights));  // of no length
}

// Red where three equal sides count as none.
TEST(Occluders, MeetTheMiddleOfARegularTriangle) {
  Mesh mesh;
  mesh.positions = {{4, 1, 1}, {1, 4, 1}, {1, 1, 4}};
  mesh.triangles = {{0, 1, 2}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  const Occluders occluders(sceneOf(std::make_shared<Mesh>(mesh)));
  EXPECT_TRUE(occluders.blocked({0, 0, 0}, {5, 5, 5}, kAllLights));
  EXPECT_TRUE(occluders.blocked({5, 5, 5}, {0, 0, 0}, kAllLights));
}

TEST(Occluders, ALightBlocksItsOwnLightAlone) {
  Scene scene;
  addLight(scene, "a", reference::quad());  // flat: blocks nothing, and counts all the same
  addLight(scene, "b", reference::bumpySphere(2000), pose({0, 0, 2}, glm::dvec3(1), 0));
  addLight(scene, "dark", reference::bumpySphere(2000), pose({0, 0, 4}, glm::dvec3(1), 0));
  scene.lights["dark"] = [&] {
    auto dark = std::make_shared<Light>(*scene.lights["dark"]);
    dark->radiance = glm::dvec3(0.0);
    return dark;
  }();
  addLight(scene, "off", reference::bumpySphere(2000), pose({0, 0, 6}, glm::dvec3(1), 0));
  scene.lights["off"] = [&] {
    auto off = std::make_shared<Light>(*scene.lights["off"]);
    off->enabled = false;
    return off;
  }();
  addLight(scene, "z", reference::bumpySphere(2000), pose({0, 0, 8}, glm::dvec3(1), 0));
  const Occluders occluders(scene);
  const auto blocked = [&](double z, int light) {
    return occluders.blocked({0.1, -3, z + 0.05}, {0.1, 3, z + 0.05}, light);
  };
  for (const int light : {kAllLights, 0, 1, 2, 3}) {
    EXPECT_FALSE(blocked(0, light)) << light;
    EXPECT_EQ(blocked(2, light), light == 1) << light;
    EXPECT_FALSE(blocked(4, light)) << light;
    EXPECT_FALSE(blocked(6, light)) << light;
    EXPECT_EQ(blocked(8, light), light == 2) << light;
  }
}

TEST(Occluders, ASurfaceBlocksAllLight) {
  Scene scene = sceneOf(reference::quad());
  addLight(scene, "a", reference::quad(), pose({0, 0, 3}, glm::dvec3(1), 0));
  for (const int light : {kAllLights, 0, 7}) EXPECT_TRUE(Occluders(scene).blocked({0.1, 0, 1}, {0.1, 0, -1}, light));
}

TEST(Occluders, WhatCastsNoShadowBlocksNothing) {
  Scene scene = sceneOf(reference::quad());
  auto surface = std::make_shared<Surface>(*scene.surfaces.begin()->second);
  surface->castsShadow = false;
  scene.surfaces.begin()->second = surface;
  addLight(scene, "b", reference::bumpySphere(2000), pose({0, 0, 3}, glm::dvec3(1), 0));
  EXPECT_TRUE(shadowsPossible(scene));
  auto light = std::make_shared<Light>(*scene.lights["b"]);
  light->castsShadow = false;
  scene.lights["b"] = light;
  EXPECT_FALSE(shadowsPossible(scene));
  EXPECT_TRUE(occludersOf(scene).empty());
  EXPECT_FALSE(Occluders(scene).blocked({0.1, 0.2, 1}, {0.1, 0.2, -1}, kAllLights));
}

TEST(Occluders, NothingBlocksWhereNothingHasArea) {
  Mesh mesh;
  mesh.positions = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {1, 1, 1}};
  mesh.triangles = {{0, 1, 2}, {1, 1, 3}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  const MeshPtr line = std::make_shared<Mesh>(mesh);
  EXPECT_TRUE(bvhOf(line)->nodes.empty());
  EXPECT_FALSE(Occluders(sceneOf(line)).blocked({1, -1, 0}, {1, 1, 0}, kAllLights));
  EXPECT_FALSE(Occluders(Scene()).blocked({1, -1, 0}, {1, 1, 0}, kAllLights));
}

class TriangleBvhTest : public ::testing::TestWithParam<std::size_t> {};

/// Whether the box of a node holds all below it, whose triangles are each noted once.
void checkNode(const TriangleBvh& bvh, std::size_t at, std::vector<int>& seen) {
  const BvhNode& node = bvh.nodes[at];
  ASSERT_GT(node.skip, at);
  ASSERT_LE(node.skip, bvh.nodes.size());
  const auto holds = [&](const glm::vec3& p) {
    return glm::all(glm::lessThanEqual(node.lower, p)) && glm::all(glm::lessThanEqual(p, node.upper));
  };
  if (node.items() == 0) {
    int children = 0;
    for (std::size_t child = at + 1; child < node.skip; child = bvh.nodes[child].skip, ++children) {
      EXPECT_TRUE(holds(bvh.nodes[child].lower) && holds(bvh.nodes[child].upper)) << at << " " << child;
      checkNode(bvh, child, seen);
    }
    EXPECT_EQ(children, 2);
    return;
  }
  EXPECT_EQ(node.skip, at + 1);
  EXPECT_LE(node.items(), 4U);
  for (std::uint32_t i = node.firstItem(); i < node.firstItem() + node.items(); ++i) seen[i]++;
}

// Red with a box of centres for that of triangles, or a leaf that begins at the wrong triangle.
TEST_P(TriangleBvhTest, HoldsEveryTriangleOnceAndInItsBoxes) {
  const MeshPtr mesh = soup(GetParam(), 9);
  const TriangleBvh bvh(*mesh);
  std::vector<int> seen(GetParam(), 0), indices(GetParam(), 0);
  ASSERT_EQ(bvh.triangles.size(), GetParam());
  checkNode(bvh, 0, seen);
  EXPECT_EQ(bvh.nodes[0].skip, bvh.nodes.size());
  for (std::size_t i = 0; i < bvh.triangles.size(); ++i) {
    const std::uint32_t index = bvh.indices[i];
    indices[index]++;
    EXPECT_EQ(bvh.triangles[i].second, mesh->positions[mesh->triangles[index].y]);
  }
  EXPECT_EQ(seen, std::vector<int>(GetParam(), 1));
  EXPECT_EQ(indices, std::vector<int>(GetParam(), 1));
}
INSTANTIATE_TEST_SUITE_P(Sizes, TriangleBvhTest, ::testing::Values(1, 4, 5, 33, 3000));

template <typename T>
bool sameBytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

TEST(TriangleBvh, IsTheSameEachTime) {
  for (const MeshPtr& mesh : {soup(5000, 11), reference::bumpySphere(5000), reference::quadOf(50)}) {
    const TriangleBvh once(*mesh), again(*mesh);
    EXPECT_TRUE(sameBytes(once.nodes, again.nodes) && sameBytes(once.triangles, again.triangles) &&
                once.indices == again.indices);
  }
}

// Triangles that lie on one another, or whose sizes halve from one to the next, do not make a tree without end.
TEST(TriangleBvh, IsMadeOfAnything) {
  Mesh same, halves;
  for (std::uint32_t i = 0; i < 5000; ++i) {
    const auto size = std::max(1e-30F, std::ldexp(1.0F, -int(i % 100)));
    for (const glm::vec3& p : {glm::vec3(0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)}) {
      same.positions.push_back(p);
      halves.positions.push_back(size * (p + 1.0F));
    }
    same.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
    halves.triangles.emplace_back(3 * i, 3 * i + 1, 3 * i + 2);
  }
  for (Mesh* mesh : {&same, &halves}) {
    const TriangleBvh bvh(*mesh);
    std::vector<int> seen(bvh.triangles.size(), 0);
    checkNode(bvh, 0, seen);
    EXPECT_EQ(seen, std::vector<int>(bvh.triangles.size(), 1));
    EXPECT_TRUE(meets(bvh, {0.2, 0.2, -1}, {0.2, 0.2, 3}) || mesh == &halves);
  }
}

TEST(TriangleBvh, IsSharedByAllWhoAskWhileTheMeshIsThere) {
  const MeshPtr mesh = reference::bumpySphere(20000);
  std::vector<TriangleBvhPtr> got(4);
  std::vector<std::thread> threads;
  for (TriangleBvhPtr& out : got) threads.emplace_back([&] { out = bvhOf(mesh); });
  for (std::thread& t : threads) t.join();
  for (const TriangleBvhPtr& bvh : got) EXPECT_EQ(bvh, got[0]);
  EXPECT_EQ(bvhOf(mesh), got[0]);
  EXPECT_NE(bvhOf(reference::bumpySphere(20000)), got[0]);
}

}  // namespace
}  // namespace lpv
