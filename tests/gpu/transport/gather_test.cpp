// GATHER on the GPU against the same sum in double (MATHS.md 3b.3-4), with the nodes that its blocks choose, and which
// blocks are summed.

#include <algorithm>
#include <cmath>
#include <random>

#include "gpu/transport/gather_rig.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/textures.h"
#include "reference/volume.h"

namespace lpv {
namespace {

const glm::dvec3 kRadiance(3.0, 2.0, 1.0), kWhite(2.0);
const Grid kGrid{{-1.0, 2.0, 0.5}, 0.5, {13, 7, 10}};
const glm::dvec3 kCentre(6.34, 3.71, 5.23);

/// Every k of which something is said.
constexpr double kRules[] = {1.5, 2.0, 6.0, test::kNoMerging};

/// Dark where a cell's centre is within a tenth of a cell of a VPL: the direction to it, and which of its sides is
/// seen, hang on digits of its place that floats do not have.
reference::Field awayFromVpls(reference::Field field, const test::GatherRig& rig) {
  for (const LightVoxelsPtr& voxels : rig.voxels) {
    for (const auto& [place, vpl] : test::vplsOf(*voxels)) {
      const glm::ivec3 cell(place.first[2], place.first[1], place.first[0]);
      if (glm::length(vpl.position - glm::dvec3(cell) - 0.5) < 0.1) field.at(cell) = {};
    }
  }
  return field;
}

class GatherFieldTest : public test::GatherTest {
 protected:
  static void expectReferences(const std::string& name, const std::vector<EmittingLight>& lights,
                               const Grid& grid = kGrid, double bound = 1e-4) {
    test::GatherRig& r = planted(grid, lights);
    for (const double k : kRules) {
      const reference::Field got = r.gather(k), want = test::expectedIncident(grid, lights, k);
      EXPECT_LE(test::relativeError(got, want), 2e-3) << name << ", k " << k;
      const reference::Field away = awayFromVpls(want, r);
      if (test::brightestCell(away) == 0.0) continue;
      EXPECT_LE(test::relativeError(awayFromVpls(got, r), away), bound) << name << ", k " << k;
    }
  }
};

EmittingLight at(const MeshPtr& mesh, double size, const glm::dvec3& radiance = kRadiance, bool twoSided = false,
                 const TexturePtr& texture = nullptr) {
  return test::placed(mesh, test::poseOf(kCentre, glm::dvec3(size)), radiance, twoSided, texture);
}

EmittingLight movedBy(EmittingLight light, const glm::dvec3& shift) {
  light.gridFromObject[3] += glm::dvec4(shift, 0.0);
  return light;
}

/// A sheet whose normals differ within a cell.
MeshPtr wavy() {
  auto mesh = std::make_shared<Mesh>(*reference::quadOf(12));
  for (glm::vec3& p : mesh->positions) p.z = 0.05F * std::sin(20.0F * p.x) * std::cos(17.0F * p.y);
  EXPECT_TRUE(finishMesh(*mesh).ok());
  return mesh;
}

// Broken by: no light from the back of curved meshes, or half of it where both sides emit; the cut of 1 / r^2 at a
// quarter of a cell; the order of coefficients.
TEST_F(GatherFieldTest, IsTheReferences) {
  expectReferences("quad", {at(reference::quad(), 5.0)});
  expectReferences("pyramid", {at(reference::pyramid(), 5.0)});
  expectReferences("tube", {at(reference::tube(), 4.0)});
  expectReferences("sphere", {at(reference::sphereOf(12, 8), 5.0)});
  expectReferences("slivers", {at(reference::slivers(60, 1e-2), 5.0)});
  expectReferences("within a cell", {at(reference::pyramid(), 0.2)});
  expectReferences("mirrored",
                   {test::placed(reference::pyramid(), test::poseOf(kCentre, {-4.0, 3.0, 5.0}, 1.9), kWhite)});
  expectReferences("sheet, both sides", {at(reference::quadOf(4), 5.0, kRadiance, true)});
  expectReferences("wavy sheet, both sides", {at(wavy(), 5.0, kRadiance, true)});
}

// Where far nodes are taken whole, from lights in the middle and at the end of the grid, where centres of nodes lie
// beyond it. Broken by: L for L^2; the box of the block's cells for that of their centres; a box that goes on
// beyond the grid.
TEST_F(GatherFieldTest, ChoosesTheReferencesNodes) {
  const Grid grid{{0.5, -1.0, 2.0}, 0.25, {45, 11, 18}};
  for (const MeshPtr& mesh : {reference::quad(), reference::tube(), reference::sphereOf(12, 8)}) {
    const EmittingLight light = test::placed(mesh, test::poseOf({7.4, 5.3, 8.2}, glm::dvec3(6.0)), kRadiance);
    expectReferences("long grid", {light}, grid);
    EXPECT_GT(test::relativeError(gathered(grid, {light}, 1.5), gathered(grid, {light}, test::kNoMerging)), 3e-4);
  }
  for (double x = 3.3; x < 45.0; x += 5.7) {
    const EmittingLight light =
        test::placed(reference::pyramid(), test::poseOf({x, 9.6, 16.4}, glm::dvec3(3.0)), kRadiance);
    expectReferences("at the end", {light}, grid);
  }
  const EmittingLight layer =
      test::placed(reference::quad(), test::poseOf({7.3, 0.4, 7.6}, glm::dvec3(11.0), 1.1, {1, 0, 0.3}), kRadiance);
  expectReferences("one layer", {layer}, test::unitGrid({40, 1, 40}));
}

// The last by 1e-3: nodes weigh places by the radianceScale channel of their mean colour, the reference by that of the
// parts. Broken by: a vector irradiance without the VPLs' colours; radiance without the radianceScale texel's.
TEST_F(GatherFieldTest, OfVaryingLightsIsTheReferences) {
  const MeshPtr bowl = test::withAttributes(reference::quadOf(3), {},
                                            [](const glm::vec3& p) { return glm::vec3(2.0F * p.x, 2.0F * p.y, 1.0F); });
  expectReferences("directions", {at(bowl, 5.0)});
  std::mt19937 random(4);
  const TexturePtr grey = reference::textureOf(
      8, 8, [&](int, int) { return glm::dvec3(std::uniform_real_distribution<double>(0.1, 1.0)(random)); });
  expectReferences("grey texture", {at(reference::quad(), 5.0, kWhite, false, grey)});
  expectReferences("grey texture, both sides", {at(reference::quad(), 5.0, kWhite, true, grey)});
  expectReferences("texture", {at(reference::quad(), 5.0, kWhite, false, reference::noise(8, 8))}, kGrid, 1e-3);
}

// One channel for one colour, for two, for three; and red, green, blue where one light has a texture.
TEST_F(GatherFieldTest, OfSeveralLightsIsTheirSum) {
  const EmittingLight red = at(reference::quad(), 3.0, {3.0, 0.2, 0.1}),
                      green = movedBy(at(reference::pyramid(), 2.0, {0.1, 2.0, 0.3}), {-3.1, 0.4, 1.7}),
                      blue = movedBy(at(reference::quad(), 2.0, {0.2, 0.1, 4.0}, true), {2.7, -0.6, -2.3}),
                      dimRed = movedBy(at(reference::quad(), 1.5, {0.3, 0.02, 0.01}), {1.1, 1.3, 2.2}),
                      picture =
                          movedBy(at(reference::quad(), 2.0, kWhite, false, reference::noise(8, 8)), {3.0, 1.0, 2.0});
  expectReferences("one colour", {red, dimRed});
  EXPECT_EQ(rig().palette.channels, 1);
  expectReferences("two colours", {red, green, dimRed});
  EXPECT_EQ(rig().palette.channels, 2);
  expectReferences("three colours", {red, green, blue});
  EXPECT_EQ(rig().palette.channels, 3);
  expectReferences("with a picture", {red, picture, green});
}

// Broken by: every group's light in the first group's channels.
TEST_F(GatherFieldTest, GroupsAreKeptApart) {
  std::vector<EmittingLight> lights = {at(reference::quad(), 3.0),
                                       movedBy(at(reference::pyramid(), 2.0), {-3.1, 0.4, 1.7}),
                                       movedBy(at(reference::quad(), 2.0, {0.1, 0.2, 4.0}, true), {2.7, -0.6, -2.3})};
  lights[1].group = lights[2].group = 1;
  test::GatherRig& r = planted(kGrid, lights);
  for (const double k : kRules) {
    r.gather(k);
    for (const int group : {0, 1})
      EXPECT_LE(test::relativeError(r.incident(group), test::expectedIncident(kGrid, lights, k, group)), 1e-4)
          << "group " << group << ", k " << k;
  }
}

// Blocks that the grid's end cuts, on every axis; lights larger than it, on its outer face, across it. Broken by: a
// column that ends one cell early; cells beyond the end that are written.
TEST_F(GatherFieldTest, WhereTheGridEndsItIsTheReferences) {
  for (const glm::ivec3 dims :
       {glm::ivec3(13, 7, 10), glm::ivec3(1, 1, 1), glm::ivec3(9, 5, 3), glm::ivec3(16, 8, 8)}) {
    const Grid grid = test::unitGrid(dims);
    const glm::dvec3 middle = 0.5 * glm::dvec3(dims) + glm::dvec3(0.17, 0.21, -0.13);
    const std::string name = std::to_string(dims.x) + "^";
    expectReferences(name + " larger",
                     {test::placed(reference::quad(), test::poseOf(middle, glm::dvec3(40.0)), kWhite)}, grid);
    glm::dvec3 face = middle;
    face.z = dims.z;
    expectReferences(
        name + " on the outer face",
        {test::placed(reference::quad(), test::poseOf(face, {4.0, -3.0, 2.0}, glm::radians(180.0), {1, 0, 0}), kWhite)},
        grid);
    const double size = dims == glm::ivec3(1) ? 0.5 : 2.0;  // the one cell's centre is not inside, where it is dark
    expectReferences(
        name + " across a corner",
        {test::placed(reference::sphereOf(12, 8), test::poseOf(glm::dvec3(dims) - 0.3, glm::dvec3(size)), kWhite)},
        grid);
  }
}

TEST_F(GatherFieldTest, ALightOutsideSendsNothing) {
  const EmittingLight inside = at(reference::quad(), 2.0), outside = movedBy(inside, {40.0, 0.0, 0.0});
  const reference::Field dark = gathered(kGrid, {outside}, 2.0);
  for (const auto& cell : dark.cells) EXPECT_EQ(cell[0], reference::Coefficients(0.0));
  expectReferences("with one inside", {outside, inside});
}

bool holds(const glm::ivec3& cell, const ReceiverBlocks& blocks) {
  const glm::ivec3 block = cell / glm::ivec3(layout::kBlockX, layout::kBlockY, layout::kBlockZ);
  return std::find(blocks.begin(), blocks.end(), std::uint32_t(block.x | block.y << 8 | block.z << 16)) != blocks.end();
}

// Every third block, then the rest, and one at a time: what all at once gives. Broken by: pieces that all begin at the
// first block; cells beyond the grid's end that are written.
TEST_F(GatherFieldTest, BlocksAreSummedOnceEach) {
  const Grid grid = test::unitGrid({37, 9, 14});
  std::vector<EmittingLight> lights = {
      test::placed(reference::sphere(), test::poseOf({9.4, 5.3, 7.2}, glm::dvec3(6.0)), {1, 2, 3}),
      test::placed(reference::quad(), test::poseOf({29.4, 4.3, 8.2}, glm::dvec3(3.0)), {3, 0, 0}, true)};
  lights[1].group = 1;
  test::GatherRig& r = planted(grid, lights);
  for (const double k : {1.5, test::kNoMerging}) {
    const reference::Field whole = r.gather(k);
    const std::vector<std::uint32_t> bits = r.bits();
    ReceiverBlocks some, others;
    for (const std::uint32_t block : allBlocks(grid.dims))
      ((some.size() + others.size()) % 3 == 1 ? some : others).push_back(block);
    r.clear();
    r.gatherBlocks(k, some);
    const reference::Field part = r.incident();
    reference::forEachCell(grid.dims, [&](const glm::ivec3& cell) {
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_EQ(part.at(cell)[c], holds(cell, some) ? whole.at(cell)[c] : reference::Coefficients(0.0));
    });
    r.gatherBlocks(k, others);
    EXPECT_EQ(r.bits(), bits);
    r.clear();
    for (int sample = 0; sample < 2; ++sample) r.clock.add(Stage::kGather, 1.0, 1.0);  // slow: one block at a time
    r.gatherBlocks(k, allBlocks(grid.dims));
    r.clock = {};
    EXPECT_EQ(r.bits(), bits);
  }
}

// A tree of more entries than one dispatch walks through; every thread of a block. Broken by: a group's first thread
// that moves the cursor on before the others have read it; half as many turns.
TEST_F(GatherFieldTest, AWalkGoesOnWhereItStopped) {
  const Grid grid = test::unitGrid({72, 72, 72});
  const EmittingLight light =
      test::placed(reference::bumpySphere(8000), test::poseOf(glm::dvec3(36.1), glm::dvec3(66.0)), glm::dvec3(1.0));
  test::GatherRig& r = planted(grid, {light});
  const std::vector<test::TreeNode> leaves = test::leavesOf(test::treeOf(*r.voxels[0]));
  std::size_t rounds = 0;
  for (const test::TreeNode& leaf : leaves) rounds += 1 + leaf.vpls.size();
  EXPECT_GT(rounds, 2U * layout::kMaxRounds);
  const ReceiverBlocks blocks = {0, 3U | 7U << 8 | 8U << 16, 8U | 17U << 8 | 17U << 16};
  r.gatherBlocks(test::kNoMerging, blocks);
  const reference::Field got = r.incident();
  for (const glm::ivec3 cell : {glm::ivec3(0), glm::ivec3(7, 3, 3), glm::ivec3(29, 30, 33), glm::ivec3(71)}) {
    double fluence = 0.0;
    for (const test::TreeNode& leaf : leaves) {
      for (const test::VplEntry& v : leaf.vpls) {
        fluence += reference::momentsOf(test::referenceOf(v), glm::dvec3(cell) + 0.5, 1.0).fluence;
      }
    }
    EXPECT_NEAR(reference::fluenceOf(got.at(cell)[0]), fluence, 1e-4 * fluence) << cell.x;  // 0 within the sphere
  }
}

}  // namespace
}  // namespace lpv
