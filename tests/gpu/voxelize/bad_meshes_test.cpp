// Meshes as files have them: what emits does so as the reference says, what cannot is skipped and counted, nothing is
// undefined (MATHS.md 2: triangles without area emit nothing).

#include <cmath>
#include <limits>

#include "gpu/support/light_rig.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/sh.h"

namespace lpv {
namespace {

const Grid kGrid = test::unitGrid({8, 7, 9});
const VoxelMethod kMethods[] = {test::kFluxMethod,
                                test::kCountMethod,
                                {Injection::kFlux, InjectionMethod::kRaster, 0},
                                {Injection::kCount, InjectionMethod::kRaster, 0}};

MeshPtr finished(Mesh mesh) {
  const Status status = finishMesh(mesh);
  EXPECT_TRUE(status.ok()) << status.message();
  return std::make_shared<const Mesh>(std::move(mesh));
}

class BadMeshesTest : public test::LightTest {
 protected:
  /// By every method: `skipped` triangles counted, the rest as the reference has it.
  static void expectDefined(const MeshPtr& mesh, std::uint32_t skipped, const glm::dmat4& pose = glm::dmat4(1.0)) {
    const EmittingLight light = test::placed(mesh, pose, glm::dvec3(1.0));
    const auto emitters = test::emittersOf(kGrid, {light});
    EXPECT_EQ(mesh->triangles.size() - emitters.size(), skipped);
    EXPECT_EQ(degenerateTriangles(*mesh), skipped);
    for (const VoxelMethod& method : kMethods) {
      const test::InjectRig& rig = injected(kGrid, {light}, method);
      EXPECT_EQ(test::read<layout::Counters>(rig.field.counters)[0].degenerate, skipped);
      const reference::Field got = test::injectedOf(rig);
      const bool flux = method.injection == Injection::kFlux;
      const reference::Field want =
          flux ? reference::injectFlux(kGrid, emitters) : reference::injectCount(kGrid, emitters).intensity;
      EXPECT_LE(test::relativeError(got, want), flux ? 1e-6 : rig.roundingError() + 1e-6) << (flux ? "FLUX" : "COUNT");
      if (!flux) continue;
      EXPECT_NEAR(reference::injectedPower(got).x / reference::injectedPower(want).x, 1.0, 1e-6);
    }
  }
};

const std::array<glm::vec3, 3> kGood = {glm::vec3(1.3F, 1.2F, 2.1F), glm::vec3(4.7F, 1.4F, 3.2F),
                                        glm::vec3(2.1F, 5.6F, 4.4F)};

// Points, segments, corners named twice. Broken by: skipping them without counting in one of the injectors.
TEST_F(BadMeshesTest, DegenerateTrianglesAreCounted) {
  const glm::vec3 a(1, 2, 3), b(4, 2, 3), c(6, 2, 3);
  expectDefined(test::meshOf({{a, a, a}, {a, b, c}, kGood, {a, b, a}, {b, a, a}, {c, a, b}}), 5);
}

// Broken by: no work-group for a light without cells.
TEST_F(BadMeshesTest, AMeshOfNothingElseIsDark) {
  const MeshPtr mesh =
      test::meshOf(std::vector(100, std::array{glm::vec3(1, 2, 3), glm::vec3(2, 2, 3), glm::vec3(4, 2, 3)}));
  for (const VoxelMethod& method : kMethods) {
    const test::InjectRig& rig = injected(kGrid, {test::placed(mesh, glm::dmat4(1.0), glm::dvec3(1.0))}, method);
    EXPECT_EQ(test::read<layout::Counters>(rig.field.counters)[0].degenerate, 100U);
    EXPECT_EQ(rig.touched(), 0U);
    EXPECT_EQ(reference::injectedPower(test::injectedOf(rig)), glm::dvec3(0.0));
  }
}

// The same triangle again and again emits each time; its back as well. Edges with three triangles are nothing special.
TEST_F(BadMeshesTest, DuplicateAndNonManifoldTrianglesAllEmit) {
  const std::array<glm::vec3, 3> back = {kGood[0], kGood[2], kGood[1]};
  expectDefined(test::meshOf({kGood, kGood, kGood, back}), 0);
  Mesh fan;
  fan.positions = {{2, 2, 2}, {5.2F, 2.3F, 2.4F}, {3, 5, 2}, {3, 2, 6}, {3, -1, 2}, {3.3F, 3, 0.2F}};
  fan.triangles = {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}, {1, 0, 5}, {0, 1, 2}};
  expectDefined(finished(fan), 0);
}

// Vertices nobody uses, far away: only bounds see them.
TEST_F(BadMeshesTest, UnusedVerticesDoNothing) {
  Mesh mesh;
  mesh.positions = {kGood[0], kGood[1], kGood[2], glm::vec3(1e9F, -1e9F, 1e9F)};
  mesh.triangles = {{0, 1, 2}};
  expectDefined(finished(mesh), 0);
}

// Normals only shade.
TEST_F(BadMeshesTest, NormalsThatAreNotNumbersDoNotEmit) {
  const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
  Mesh mesh = *reference::sphere();
  for (std::size_t i = 0; i < mesh.normals.size(); i += 2) mesh.normals[i] = glm::vec3(i % 4 == 0 ? nan : infinity);
  const MeshPtr repaired = finished(mesh);
  for (const glm::vec3& n : repaired->normals) EXPECT_NEAR(glm::length(n), 1.0F, 1e-5F);
  expectDefined(repaired, 0, test::poseOf({4.1, 3.3, 4.6}, glm::dvec3(5.0)));
}

// Vertices a million units from the mesh's origin, brought back by the transform: what floats have left of them.
// Broken by: gridPoint() in float.
TEST_F(BadMeshesTest, FarOffsets) {
  const glm::dvec3 far(1e6, -1e6, 1e6);
  Mesh mesh = *reference::sphere();
  for (glm::vec3& p : mesh.positions) p = 40.0F * p + glm::vec3(far);
  glm::dmat4 pose(0.1);
  pose[3] = glm::dvec4(glm::dvec3(4.2, 3.4, 4.4) - 0.1 * far, 1.0);
  const MeshPtr moved = finished(mesh);
  expectDefined(moved, std::uint32_t(degenerateTriangles(*moved)), pose);
}

// Triangles of 1e-9 units: by themselves in a cell, and blown up to many cells by their transform.
// Broken by: an absolute smallest area in loadTriangle().
TEST_F(BadMeshesTest, TinyTriangles) {
  Mesh tiny = *reference::sphere();
  for (glm::vec3& p : tiny.positions) p *= 1e-9F;
  const MeshPtr mesh = finished(tiny);
  expectDefined(mesh, 0, test::poseOf({4.2, 3.4, 4.4}, glm::dvec3(1.0)));
  expectDefined(mesh, 0, test::poseOf({4.2, 3.4, 4.4}, glm::dvec3(5e9)));
}

// A scale of zero along one axis flattens the mesh: some triangles keep an area, those seen edge-on lose it.
TEST_F(BadMeshesTest, FlatScales) {
  const EmittingLight flat = test::placed(reference::box(glm::dvec3(-0.5), glm::dvec3(0.5)),
                                          test::poseOf({4.2, 3.4, 4.4}, {4.0, 3.0, 0.0}, 0.0), glm::dvec3(1.0));
  for (const VoxelMethod& method : kMethods) {
    const test::InjectRig& rig = injected(kGrid, {flat}, method);
    EXPECT_EQ(test::read<layout::Counters>(rig.field.counters)[0].degenerate, 8U);
    const double power = reference::injectedPower(test::injectedOf(rig)).x;
    EXPECT_TRUE(std::isfinite(power) && power > 0.0);
    if (method.injection != Injection::kFlux) continue;
    EXPECT_NEAR(power / (2.0 * reference::pi() * 12.0), 1.0, 1e-6);
  }
}

}  // namespace
}  // namespace lpv
