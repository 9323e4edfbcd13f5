// What injection must keep (MATHS.md 6): linearity and symmetry (7), opposite faces in one cell (9), the fixed point at
// its limit (11).

#include "gpu/failure.h"
#include "gpu/support/light_rig.h"
#include "reference/compare.h"
#include "reference/inject.h"
#include "reference/meshes.h"
#include "reference/textures.h"
#include "scene/sh.h"

namespace lpv {
namespace {

class SymmetryTest : public test::LightTest {
 protected:
  static reference::Field fieldOf(const Grid& grid, const std::vector<EmittingLight>& lights,
                                  const VoxelMethod& method) {
    return test::injectedOf(injected(grid, lights, method));
  }
};

constexpr int kCells = 8;
const Grid kCube = test::unitGrid(glm::ivec3(kCells));
const glm::dvec3 kMiddle(0.5 * kCells);

EmittingLight tangled(bool varying, const glm::dmat3& symmetry) {
  glm::dmat4 pose(symmetry * 3.9);
  pose[3] = glm::dvec4(kMiddle, 1.0);
  return test::placed(test::tangle(varying), pose, {3, 2, 1}, false, varying ? reference::noise(8, 4) : nullptr);
}

// Broken by: the determinant's sign left out of outwardFromObject.
TEST_F(SymmetryTest, Invariant07TheFieldTurnsWithTheLight) {
  for (const bool varying : {false, true}) {
    for (const VoxelMethod& method : {test::kFluxMethod, test::kCountMethod}) {
      const reference::Field upright = fieldOf(kCube, {tangled(varying, glm::dmat3(1.0))}, method);
      double worst = 0.0;
      for (const glm::dmat3& symmetry : test::cubeSymmetries()) {
        const reference::Field turned = fieldOf(kCube, {tangled(varying, symmetry)}, method);
        worst = std::max(worst, test::relativeError(turned, test::turned(upright, symmetry)));
      }
      const bool flux = method.injection == Injection::kFlux;
      RecordProperty(std::string(flux ? "flux" : "count") + (varying ? "_varying" : ""),
                     std::to_string(1e9 * worst) + "e-9");
      EXPECT_LE(worst, flux ? 1e-6 : 3e-6) << varying;
    }
  }
}

reference::Field sum(const reference::Field& a, double factor, const reference::Field& b) {
  reference::Field out = a;
  for (std::size_t i = 0; i < out.cells.size(); ++i) {
    for (std::size_t c = 0; c < 3; ++c) out.cells[i][c] = a.cells[i][c] + factor * b.cells[i][c];
  }
  return out;
}

// Broken by: the square of a light's weight.
TEST_F(SymmetryTest, Invariant07IsLinearInRadiance) {
  EmittingLight one = tangled(false, glm::dmat3(1.0)), tripled = one;
  tripled.radiance *= 3.0;
  EmittingLight other = test::placed(reference::sphere(), test::poseOf(kMiddle, glm::dvec3(4.0)), 0.25 * one.radiance);
  for (const VoxelMethod& method : {test::kFluxMethod, test::kCountMethod}) {
    const reference::Field once = fieldOf(kCube, {one}, method);
    EXPECT_LE(test::relativeError(fieldOf(kCube, {tripled}, method), sum(once, 2.0, once)), 1e-6);
  }
  for (const glm::dvec3 colour : {other.radiance, glm::dvec3(0.5, 0.1, 2.0)}) {  // a channel for both, one for each
    other.radiance = colour;
    const reference::Field apart =
        sum(fieldOf(kCube, {one}, test::kFluxMethod), 1.0, fieldOf(kCube, {other}, test::kFluxMethod));
    EXPECT_LE(test::relativeError(fieldOf(kCube, {one, other}, test::kFluxMethod), apart), 1e-6);
  }
}

// Broken by: abs() of the normal.
TEST_F(SymmetryTest, Invariant07OrderDoesNotMatterAndWindingTurnsTheSide) {
  EmittingLight light = tangled(false, glm::dmat3(1.0));
  auto rolled = std::make_shared<Mesh>(*light.mesh), flipped = std::make_shared<Mesh>(*light.mesh);
  for (glm::uvec3& t : rolled->triangles) t = {t.y, t.z, t.x};
  for (glm::uvec3& t : flipped->triangles) t = {t.x, t.z, t.y};
  for (const VoxelMethod& method : {test::kFluxMethod, test::kCountMethod}) {
    const reference::Field before = fieldOf(kCube, {light}, method);
    EmittingLight changed = light;
    changed.mesh = rolled;
    EXPECT_LE(test::relativeError(fieldOf(kCube, {changed}, method), before), 1e-6);
    changed.mesh = flipped;
    reference::Field back = fieldOf(kCube, {changed}, method);
    for (auto& cell : back.cells) {
      for (reference::Coefficients& c : cell) c = {c.x, -c.y, -c.z, -c.w};
    }
    EXPECT_LE(test::relativeError(back, before), 1e-6);
  }
}

// A plate whose two faces share cells: both powers are there, and the directions cancel (.2 %).
// Broken by: abs() of the normal; no carry in addWide().
TEST_F(SymmetryTest, Invariant09OppositeFacesInOneCell) {
  const MeshPtr plate = reference::box({-1.7, -1.3, -0.02}, {1.7, 1.3, 0.02});
  for (const double angle : {0.0, 0.9}) {
    const EmittingLight light =
        test::placed(plate, test::poseOf({4.3, 4.4, 4.5}, glm::dvec3(1.0), angle), glm::dvec3(1.0));
    const reference::Field got = fieldOf(kCube, {light}, test::kFluxMethod);
    const auto emitters = test::emittersOf(kCube, {light});
    EXPECT_LE(test::relativeError(got, reference::injectFlux(kCube, emitters)), 1e-6);
    EXPECT_NEAR(reference::injectedPower(got).x / reference::powerOf(emitters).x, 1.0, 1e-6);
    reference::Coefficients net(0.0);
    for (const auto& cell : got.cells) net += cell[0];
    EXPECT_LE(glm::length(glm::dvec3(net.y, net.z, net.w)) / net.x, 2e-3);
  }
}

/// `count` times one triangle within a cell, its front towards -z: fixed point must hold negative sums too.
MeshPtr pile(std::size_t count) {
  return test::meshOf(std::vector(
      count, std::array{glm::vec3(0.2F, 0.2F, 0.5F), glm::vec3(0.2F, 0.8F, 0.5F), glm::vec3(0.8F, 0.2F, 0.5F)}));
}

// Areas as shares of the light's: their sum is 2^50 however many triangles there are. Broken by: no carry in addWide().
TEST_F(SymmetryTest, Invariant11FluxHoldsEverySum) {
  const Grid one = test::unitGrid({1, 1, 1});
  for (const std::size_t count : {1U, 2U, 33446U, 300000U}) {
    const auto cell = fieldOf(one, {test::lightOf(pile(count), glm::dvec3(1.0))}, test::kFluxMethod).cells[0][0];
    const double area = 0.18 * double(count);
    EXPECT_NEAR(cell.x / (sh::kLobe0 * area), 1.0, 1e-6) << count;
    EXPECT_NEAR(cell.z / (-sh::kLobe1 * area), 1.0, 1e-6) << count;
  }
}

// As many lobes as the shift was chosen for, of one, of three by three directions, and of white texels.
// Broken by: a shift one larger in fixedPointFor; lobesPerTriangle 1 for directed lights.
TEST_F(SymmetryTest, Invariant11CountHoldsEverySum) {
  const Grid one = test::unitGrid({1, 1, 1});
  const TexturePtr white = reference::textureOf(1, 1, [](int, int) { return glm::dvec3(1.0); });
  for (const std::size_t count : {2048U, 28000U, 60000U}) {
    auto spread = std::make_shared<Mesh>(*pile(count));
    for (std::size_t i = 0; i < 3 * count; ++i) {
      spread->directions.emplace_back(i % 3 == 0 ? 1.0F : -1.0F, 0.0F, 0.0F);
      spread->uvs.emplace_back(0.5F);
    }
    const auto got = [&](const EmittingLight& light) { return fieldOf(one, {light}, test::kCountMethod).cells[0][0]; };
    const EmittingLight textured = test::placed(spread, glm::dmat4(1.0), glm::dvec3(1.0), false, white);
    EXPECT_NEAR(got(test::lightOf(pile(count), glm::dvec3(1.0))).z, -sh::kLobe1, 1e-4) << count;
    EXPECT_NEAR(got(textured).x, sh::kLobe0, 1e-4) << count;
    EXPECT_NEAR(test::voxelsOf(*injected(one, {textured}, test::kCountMethod).voxels[0]).at(0).first, 9 * count, 0);
  }
}

// What would not fit is refused before anything is summed. Broken by: kCoarsest 0.
TEST_F(SymmetryTest, Invariant11WhatDoesNotFitIsRefused) {
  const EmittingLight light = test::lightOf(pile(200), glm::dvec3(1.0));
  try {
    injected(test::unitGrid({1, 1, 1}), {light}, {Injection::kCount, InjectionMethod::kDense, 1000000});
    FAIL() << "200 million lobes in one cell";
  } catch (const gpu::Failure& failure) {
    EXPECT_EQ(failure.status().code(), Code::kResourceExhausted);
  }
}

}  // namespace
}  // namespace lpv
