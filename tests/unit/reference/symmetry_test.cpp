// Linearity, vertex order and the 48 symmetries of the grid, for every way of injection (MATHS.md 6.7, 6.2).
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <random>

#include "reference/compare.h"
#include "reference/dense.h"
#include "reference/inject.h"
#include "reference/textures.h"
#include "unit/reference/fixtures.h"

namespace lpv::reference {
namespace {

constexpr int kCells = 8;

Grid gridOf() {
  Grid grid;
  grid.cell = 0.25;
  grid.dims = glm::ivec3(kCells);
  grid.origin = glm::dvec3(-1.0);
  return grid;
}

using Inject = std::function<Field(const Grid&, const std::vector<Emitter>&)>;

/// Every way of injection, by name.
std::vector<std::pair<std::string, Inject>> ways() {
  return {{"COUNT", [](const Grid& g, const auto& e) { return injectCount(g, e).intensity; }},
          {"FLUX", [](const Grid& g, const auto& e) { return injectFlux(g, e); }},
          {"dense", [](const Grid& g, const auto& e) { return injectDense(g, e, 20).intensity; }}};
}

/// Random triangles with uvs and directions: nothing about them is on a tie.
Mesh tangle() {
  std::mt19937 random(3);
  std::uniform_real_distribution<float> place(-0.93F, 0.93F);
  Mesh mesh;
  for (std::uint32_t i = 0; i < 15; ++i) {
    const auto point = [&] {
      const float x = place(random);
      const float y = place(random);
      return glm::vec3(x, y, place(random));
    };
    mesh.positions.push_back(point());
    mesh.directions.push_back(point());
    mesh.uvs.emplace_back(point());
    if (i % 3 == 0) mesh.triangles.emplace_back(i, i + 1, i + 2);
  }
  return mesh;
}

MipChainPtr picture() { return std::make_shared<const MipChain>(mipChainOf(*noise(6, 5))); }

std::vector<Emitter> emittersUnder(const glm::dmat3& linear, const Mesh& mesh) {
  return emittersOf(gridOf(), mesh, glm::dmat4(linear), {3.0, 2.0, 1.0}, false, picture()).triangles;
}

Field transformed(const Field& field, const glm::dmat3& m) {
  Field out(field.dims);
  forEachCell(field.dims, [&](const glm::ivec3& cell) {
    const glm::dvec3 centre = m * (glm::dvec3(cell) + 0.5 - 0.5 * kCells);
    const glm::ivec3 to(glm::floor(centre + 0.5 * kCells));
    for (std::size_t c = 0; c < 3; ++c) {
      const Coefficients& from = field.at(cell)[c];
      const glm::dvec3 vector = m * glm::dvec3(from.w, from.y, from.z);
      out.at(to)[c] = {from.x, vector.y, vector.z, vector.x};
    }
  });
  return out;
}

// Red when one axis is treated unlike the others: in the snap, the clip, the box, or the order of coefficients.
TEST(Symmetry, InjectionTurnsWithTheLight) {
  const Mesh mesh = tangle();
  ASSERT_EQ(symmetries().size(), 48U);
  for (const auto& [name, inject] : ways()) {
    const Field plain = inject(gridOf(), emittersUnder(glm::dmat3(1.0), mesh));
    for (const glm::dmat3& m : symmetries()) {
      EXPECT_LE(relativeL2(inject(gridOf(), emittersUnder(m, mesh)), transformed(plain, m)), 1e-9) << name;
    }
  }
}

TEST(Symmetry, VertexOrderDoesNotMatter) {
  Mesh turned = tangle();
  for (glm::uvec3& t : turned.triangles) t = {t.y, t.z, t.x};
  for (const auto& [name, inject] : ways()) {
    if (name == "dense") continue;  // where samples lie follows A, B, C
    const Field plain = inject(gridOf(), emittersUnder(glm::dmat3(1.0), tangle()));
    EXPECT_LE(relativeL2(inject(gridOf(), emittersUnder(glm::dmat3(1.0), turned)), plain), 1e-9) << name;
  }
}

// Directions are what the mesh says, whichever side is the front; without them the side turns over.
TEST(Symmetry, WindingTurnsTheSideButNotDirections) {
  Mesh flipped = tangle();
  for (glm::uvec3& t : flipped.triangles) t = {t.x, t.z, t.y};
  const glm::dmat3 same(1.0);
  for (const auto& [name, inject] : ways()) {
    if (name == "dense") continue;
    const Field plain = inject(gridOf(), emittersUnder(same, tangle()));
    EXPECT_LE(relativeL2(inject(gridOf(), emittersUnder(same, flipped)), plain), 1e-9) << name;
    Mesh bare = tangle();
    bare.directions.clear();
    Field front = inject(gridOf(), emittersUnder(same, bare));
    bare.triangles = flipped.triangles;
    for (auto& cell : front.cells) {
      for (Coefficients& c : cell) c = {c.x, -c.y, -c.z, -c.w};
    }
    EXPECT_LE(relativeL2(inject(gridOf(), emittersUnder(same, bare)), front), 1e-12) << name;
  }
}

TEST(Symmetry, InjectionIsLinearInRadiance) {
  for (const auto& [name, inject] : ways()) {
    std::vector<Emitter> emitters = emittersUnder(glm::dmat3(1.0), tangle());
    Field one = inject(gridOf(), emitters);
    for (Emitter& e : emitters) e.radiance *= 1e6;
    const Field many = inject(gridOf(), emitters);
    for (auto& cell : one.cells) {
      for (Coefficients& c : cell) c *= 1e6;
    }
    EXPECT_LE(relativeL2(many, one), 1e-12) << name;
  }
}

// 6.2: the lattice does not see 1e-12 of a cell, so pairs and parts stay; only positions could move, by as much.
TEST(Symmetry, AShiftOf1e12ChangesNothing) {
  const Mesh mesh = tangle();
  for (const auto& [name, inject] : ways()) {
    const Field plain = inject(gridOf(), emittersUnder(glm::dmat3(1.0), mesh));
    for (const double shift : {1e-12, -1e-12}) {
      glm::dmat4 moved(1.0);
      moved[3] = {shift, -shift, shift, 1.0};
      const auto emitters = emittersOf(gridOf(), mesh, moved, {3.0, 2.0, 1.0}, false, picture()).triangles;
      EXPECT_LE(relativeL2(inject(gridOf(), emitters), plain), 1e-9) << name;
    }
  }
}

}  // namespace
}  // namespace lpv::reference
