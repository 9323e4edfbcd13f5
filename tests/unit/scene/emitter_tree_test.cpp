// The tree over a light's triangles, from afar and from where it touches, against the closed form.
#include "scene/emitter_tree.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "reference/emitter.h"
#include "reference/ground_truth.h"
#include "reference/meshes.h"
#include "scene/emitter_list.h"
#include "shaders/layout.h"

namespace lpv {
namespace {

const Grid kSpace = {{1.0, -2.0, 0.5}, 0.25, glm::ivec3(16)};

/// As a tick makes it.
EmitterList listOf(const Light& light, double k) {
  const PlacedEmitterTree placed =
      emitterTreeOf(light.mesh, kSpace.gridFromWorldMatrix() * light.transform.worldFromObject());
  const glm::mat4 rows(glm::transpose(placed.treeFromGrid));
  EmitterList out;
  out.grid = kSpace;
  out.always = true;
  out.texels = {glm::vec4(1.0F, float(k), 0.0F, 0.0F), glm::vec4(light.radiance, layout::kAsEmitterTree),
                glm::vec4(3.0F, float(placed.tree->entries), light.twoSided ? 2.0F : 1.0F, 4.0F)};
  for (int i = 0; i < 3; ++i) out.texels.push_back(rows[i]);
  out.texels.insert(out.texels.end(), placed.tree->texels.begin(), placed.tree->texels.end());
  return out;
}

Light lightWith(const MeshPtr& mesh, const Transform& transform = {}) {
  Light light;
  light.name = "light";
  light.mesh = mesh;
  light.transform = transform;
  return light;
}

glm::dvec3 unitVector(std::mt19937& random) {
  std::normal_distribution<double> normal;
  const double x = normal(random), y = normal(random);
  return glm::normalize(glm::dvec3(x, y, normal(random)));
}

/// Points that far from the mesh, as seen along a random direction from its middle, with random normals.
std::vector<std::pair<glm::dvec3, glm::dvec3>> pointsAround(const Light& light, double apart) {
  std::mt19937 random(7);
  std::vector<std::pair<glm::dvec3, glm::dvec3>> out;
  const auto& positions = light.mesh->positions;
  const glm::dmat4 world = light.transform.worldFromObject();
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 vertex(world * glm::dvec4(glm::dvec3(positions[random() % positions.size()]), 1.0));
    const glm::dvec3 out_ = glm::normalize(vertex - light.transform.translation + 1e-9);
    out.emplace_back(vertex + apart * out_, unitVector(random));
  }
  return out;
}

/// Shares of pi radiance: what a closed hemisphere would send.
struct Differences {
  double worst = 0.0, rms = 0.0;
};

Differences differencesOf(const Light& light, double k, double apart) {
  const EmitterList list = listOf(light, k);
  Scene scene;
  scene.grid = kSpace;
  scene.lights["light"] = std::make_shared<Light>(light);
  const auto emitters = reference::emittersOf(scene).triangles;
  Differences out;
  const auto points = pointsAround(light, apart);
  for (const auto& [x, n] : points) {
    const double want = reference::irradianceOf(emitters, x, n).x;
    const double off = std::abs(list.irradiance(x, n).x - want) / (std::acos(-1.0) * light.radiance.x);
    out.worst = std::max(out.worst, off);
    out.rms += off * off;
  }
  out.rms = std::sqrt(out.rms / double(points.size()));
  return out;
}

// At the surface, too, where a VPL of a cell would be half of the truth. Broken by: leaves that stay VPLs (.4).
TEST(EmitterTree, IsRightFromAnyDistance) {
  for (const MeshPtr& mesh : {reference::sphere(), reference::bumpySphere(2000), reference::bumpySphere(20000)}) {
    const Light light = lightWith(mesh, {{2.0, -1.0, 1.5}});
    for (const double apart : {0.001, 0.01, 0.05, 0.2, 1.0, 4.0}) {
      const Differences fast = differencesOf(light, kFastOpeningRatio, apart),
                        accurate = differencesOf(light, kAccurateOpeningRatio, apart);
      EXPECT_LE(fast.worst, 0.01) << mesh->triangles.size() << ", " << apart;
      EXPECT_LE(fast.rms, 0.002) << mesh->triangles.size() << ", " << apart;
      EXPECT_LE(accurate.worst, 0.004) << mesh->triangles.size() << ", " << apart;
      EXPECT_LE(accurate.rms, 0.0006) << mesh->triangles.size() << ", " << apart;
    }
  }
}

// A ratio that opens every node is the sum of the triangles, in single precision.
TEST(EmitterTree, OpenedWhollyIsItsTriangles) {
  for (const Transform& transform :
       {Transform{{2.0, -1.0, 1.5}}, Transform{{2.0, -1.0, 1.5}, rotationFromEulerDegrees({20.0, 30.0, 40.0})},
        Transform{{2.0, -1.0, 1.5}, rotationFromEulerDegrees({20.0, 30.0, 40.0}), {1.0, 0.5, 2.0}},
        Transform{{2.0, -1.0, 1.5}, rotationFromEulerDegrees({20.0, 30.0, 40.0}), {-1.0, 0.5, 2.0}}}) {
    Light light = lightWith(reference::bumpySphere(400), transform);
    for (const bool twoSided : {false, true}) {
      light.twoSided = twoSided;
      EXPECT_LE(differencesOf(light, 1e15, 0.3).worst, 1e-5) << transform.scale.x << twoSided;
    }
  }
}

// Whatever the tree's order, all of the area is in its root. Broken by: children left out whose parents are.
TEST(EmitterTree, TheRootHoldsAllOfIt) {
  const MeshPtr mesh = reference::bumpySphere(2000);
  const EmitterTree tree(*mesh, glm::dvec3(1.0));
  double area = 0.0, want = 0.0;
  const int vpls = int(tree.texels[1].x);
  EXPECT_EQ(tree.texels[1].y, float(tree.entries)) << "after the root there is nothing";
  for (int i = 1; i <= vpls; ++i) area += double(tree.texels[std::size_t(4 * i)].w);
  for (const glm::uvec3& t : mesh->triangles) {
    const auto& p = mesh->positions;
    want += 0.5 * double(glm::length(glm::cross(p[t.y] - p[t.x], p[t.z] - p[t.x])));
  }
  EXPECT_NEAR(area, want * tree.unit * tree.unit, 1e-4 * area);
}

TEST(EmitterTree, IsMadeOncePerMeshAndShape) {
  const MeshPtr mesh = reference::sphere();
  const auto treeOf = [&mesh](const Transform& t) { return emitterTreeOf(mesh, t.worldFromObject()).tree; };
  const EmitterTreePtr tree = treeOf({});
  EXPECT_EQ(treeOf({{1.0, 2.0, 3.0}, rotationFromEulerDegrees({10.0, 20.0, 30.0}), glm::dvec3(0.3)}), tree);
  EXPECT_NE(treeOf({{}, {1.0, 0.0, 0.0, 0.0}, {1.0, 2.0, 1.0}}), tree);
}

TEST(EmitterTree, AMeshWithoutAreaIsEmpty) {
  Mesh mesh;
  mesh.positions = {glm::vec3(0.0F), glm::vec3(1.0F), glm::vec3(2.0F)};
  mesh.triangles = {{0, 1, 2}};
  ASSERT_TRUE(finishMesh(mesh).ok());
  EXPECT_EQ(EmitterTree(mesh, glm::dvec3(1.0)).entries, 0U);
}

}  // namespace
}  // namespace lpv
