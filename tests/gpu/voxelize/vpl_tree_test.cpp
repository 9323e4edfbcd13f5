// Lights as VPLs and the tree over them (MATHS.md 3b.1-2): the leaves against the double reference, nodes against their
// children, and the order in which they lie in memory.

#include <cmath>
#include <random>

#include "gpu/transport/gather_rig.h"
#include "reference/meshes.h"
#include "reference/sh.h"
#include "reference/textures.h"

namespace lpv {
namespace {

const Grid kGrid{{-1.0, 2.0, 0.5}, 0.5, {13, 11, 12}};
const glm::dvec3 kCentre(6.3, 5.6, 6.1);
const glm::dvec3 kRadiance(3.0, 2.0, 1.0), kWhite(2.0);
const glm::dmat4 kPose = test::poseOf(kCentre, glm::dvec3(6.0));

class VplsTest : public test::GatherTest {
 protected:
  static const LightVoxels& voxelsOf(const EmittingLight& light) { return *planted(kGrid, {light}).voxels[0]; }
};

/// What differs at most between two sets of VPLs, the places left out that one has and the other has not: those are
/// counted.
struct VplErrors {
  double area = 0.0;  ///< cell^2, as a share of the largest VPL's
  double direction = 0.0;  ///< area x direction, likewise
  double position = 0.0;  ///< cells, where the area is at least 1e-3 of the largest
  double covariance = 0.0;  ///< cell^2, likewise
  double colour = 0.0;  ///< as a share of the largest colour, likewise
  std::size_t unmatched = 0;
};

double largestOf(const glm::dvec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

VplErrors errorsOf(const test::VplMap& got, const test::VplMap& want) {
  double area = 0.0, colour = 0.0;
  for (const auto& [place, vpl] : want) {
    area = std::max(area, vpl.area);
    colour = std::max(colour, largestOf(vpl.colour));
  }
  VplErrors e;
  for (const auto& [place, vpl] : want) {
    const auto found = got.find(place);
    if (found == got.end()) {
      ++e.unmatched;
      continue;
    }
    const test::VplEntry& g = found->second;
    e.area = std::max(e.area, std::abs(g.area - vpl.area) / area);
    e.direction = std::max(e.direction, largestOf(g.direction - vpl.direction) / area);
    if (vpl.area < 1e-3 * area) continue;
    e.position = std::max(e.position, largestOf(g.position - vpl.position));
    for (int i = 0; i < 3; ++i)
      e.covariance = std::max(e.covariance, largestOf(g.positionCovariance[i] - vpl.positionCovariance[i]));
    e.colour = std::max(e.colour, largestOf(g.colour - vpl.colour) / colour);
  }
  e.unmatched += got.size() + e.unmatched - want.size();
  return e;
}

/// Bowl of directions over the mesh's xy plane.
MeshPtr directed(const MeshPtr& mesh) {
  return test::withAttributes(mesh, {}, [](const glm::vec3& p) { return glm::vec3(2.0F * p.x, 2.0F * p.y, 1.0F); });
}

void expectReferences(const LightVoxels& voxels, const EmittingLight& light, const std::string& name) {
  const VplErrors e = errorsOf(test::vplsOf(voxels), test::expectedVpls(kGrid, light, voxels.radianceScale));

  EXPECT_EQ(e.unmatched, 0U) << name;
  EXPECT_LE(e.area, 1e-6) << name;
  EXPECT_LE(e.direction, 1e-6) << name;
  EXPECT_LE(e.position, 1e-4) << name;
  EXPECT_LE(e.covariance, 1e-6) << name;
  EXPECT_LE(e.colour, 1e-5) << name;
}

// Broken by: the middle third of normalBin() up to 1/2; opposite normals in one bin; a part's centroid that of the
// whole triangle, or its boundary's moment over 2.9 areas; abs() of the direction; an extent along the normal; no carry
// in addWide(); entries left in the table, or their high words.
TEST_F(VplsTest, LeavesAreTheReferences) {
  const std::vector<std::pair<std::string, MeshPtr>> meshes = {{"quad", reference::quad()},
                                                               {"pyramid", reference::pyramid()},
                                                               {"tube", reference::tube()},
                                                               {"sphere", reference::sphereOf(12, 8)},
                                                               {"fine", reference::bumpySphere(2000)},
                                                               {"slivers", reference::slivers(60, 1e-2)}};
  for (const auto& [name, mesh] : meshes) {
    for (const glm::dmat4& pose :
         {kPose, test::poseOf(kCentre, {-7.0, 3.0, 5.0}, 1.9, {2, -1, 1}), test::poseOf(kCentre, glm::dvec3(0.3), 2.6),
          test::poseOf({1.2, 10.1, 6.1}, glm::dvec3(9.0), 0.9, {-1, 1, 3})}) {
      const EmittingLight light = test::placed(mesh, pose, kRadiance);
      expectReferences(voxelsOf(light), light, name);
    }
  }
}

// White light: the reference weighs places by what leaves them, the product by the texture alone, so that a change of
// colour leaves the tree as it is. Broken by: places weighted by area.
TEST_F(VplsTest, LeavesOfVaryingLightsAreTheReferences) {
  const TexturePtr texture = reference::noise(8, 8);
  for (const glm::dmat4& pose : {kPose, test::poseOf({1.2, 10.1, 6.1}, {-9.0, 8.0, 9.0}, 0.9, {-1, 1, 3})}) {
    EmittingLight light = test::placed(directed(reference::quadOf(3)), pose, kRadiance);
    expectReferences(voxelsOf(light), light, "directions");
    light = test::placed(reference::quadOf(2), pose, kWhite, false, texture);
    expectReferences(voxelsOf(light), light, "texture");
    light = test::placed(reference::quad(), pose, kWhite, true, texture);
    expectReferences(voxelsOf(light), light, "two-sided");
  }
}

/// Power of the leaves' VPLs of one side, W, of red.
double powerOf(const LightVoxels& voxels, const EmittingLight& light) {
  double power = 0.0;
  for (const auto& [place, vpl] : test::vplsOf(voxels)) {
    power += vpl.area * kGrid.cell * kGrid.cell * light.radiance.r * vpl.colour.r * voxels.radianceScale;
  }
  return power * reference::pi();
}

// Broken by: no carry in addWide(); bins beyond the 32nd left out of placeOf().
TEST_F(VplsTest, LeavesCarryTheLightsPower) {
  const TexturePtr texture = reference::noise(8, 8);
  for (const double size : {0.01, 0.4, 5.0}) {
    for (const MeshPtr& mesh :
         {reference::quad(), reference::pyramid(), reference::sphere(), reference::slivers(200, 1e-2)}) {
      for (const TexturePtr& t : {TexturePtr(), mesh->uvs.empty() ? TexturePtr() : texture}) {
        const EmittingLight light = test::placed(mesh, test::poseOf(kCentre, glm::dvec3(size)), kWhite, false, t);
        EXPECT_NEAR(powerOf(voxelsOf(light), light) / reference::powerOf(test::emittersOf(kGrid, {light})).r, 1.0, 1e-6)
            << mesh->triangles.size() << " triangles, " << size << " cells";
      }
    }
  }
}

/// Sums of nodes' VPLs: what merging keeps, but for the weights of several colours in several bins.
struct Sums {
  double area = 0.0, weight = 0.0;
  glm::dvec3 direction{0.0}, position{0.0}, colour{0.0};
  glm::dmat3 square{0.0};
  void add(const test::VplEntry& v) {
    const double radianceScale = v.area * std::max({v.colour.r, v.colour.g, v.colour.b});
    area += v.area;
    weight += radianceScale;
    direction += v.direction;
    position += radianceScale * v.position;
    square += radianceScale * (v.positionCovariance + glm::outerProduct(v.position, v.position));
    colour += v.area * v.colour;
  }
};

Sums sumsOf(const std::vector<test::TreeNode>& nodes) {
  Sums sums;
  for (const test::TreeNode& node : nodes) {
    for (const test::VplEntry& v : node.vpls) sums.add(v);
  }
  return sums;
}

/// A node holds its children and what they hold, and no bin twice.
void expectMerged(const test::TreeNode& node) {
  for (const test::VplEntry& v : node.vpls) {
    reference::Vpl vpl;
    vpl.area = v.area;
    vpl.areaNormal = v.direction;
    EXPECT_NEAR(v.spread, reference::spreadOf(vpl), 2e-3 * v.area);
  }
  if (node.children.empty()) {
    EXPECT_EQ(node.edge, 1.0);
    return;
  }
  EXPECT_GT(node.children.size(), 1U) << "an only child says as much";
  std::size_t most = 0, all = 0;
  for (const test::TreeNode& child : node.children) {
    EXPECT_LE(2.0 * child.edge, node.edge);
    EXPECT_LE(largestOf(child.centre - node.centre) + 0.5 * child.edge, 0.5 * node.edge);
    most = std::max(most, child.vpls.size());
    all += child.vpls.size();
    expectMerged(child);
  }
  EXPECT_GE(node.vpls.size(), most);
  EXPECT_LE(node.vpls.size(), std::min<std::size_t>(all, layout::kNormalBins));
  const Sums own = sumsOf({node}), below = sumsOf(node.children);
  EXPECT_NEAR(own.area, below.area, 1e-6 * below.area);
  EXPECT_LE(largestOf(own.direction - below.direction), 1e-6 * below.area);
  EXPECT_LE(largestOf(own.position / own.weight - below.position / below.weight), 1e-6 * node.edge);
  const glm::dvec3 at = own.position / own.weight;  // about it: what is far from the origin has few digits there
  for (int i = 0; i < 3; ++i) {
    const auto about = [&](const Sums& s) {
      return s.square[i] / s.weight - at[i] * s.position / s.weight - at * (s.position[i] / s.weight - at[i]);
    };
    EXPECT_LE(largestOf(about(own) - about(below)), 2e-6 * node.edge * node.edge);
  }
  EXPECT_LE(largestOf(own.colour - below.colour), 1e-6 * largestOf(below.colour));
}

const std::vector<EmittingLight>& treeLights() {
  static const std::vector<EmittingLight> lights = {
      test::placed(reference::quad(), kPose, kWhite), test::placed(reference::sphere(), kPose, kWhite),
      test::placed(reference::slivers(60, 1e-2), kPose, kWhite),
      test::placed(reference::tube(), test::poseOf({1.2, 10.1, 6.1}, glm::dvec3(9.0), 0.9), kWhite),
      test::placed(reference::quad(), test::poseOf(kCentre, glm::dvec3(0.01)), kWhite),
      test::placed(reference::quadOf(2), kPose, kWhite, false, reference::noise(8, 8)),
      // Two triangles in opposite corners: chains of blocks with one child.
      test::placed(test::meshOf({{{{0.1F, 0.2F, 0.3F}, {0.6F, 0.2F, 0.3F}, {0.1F, 0.7F, 0.4F}}},
                                 {{{12.1F, 10.2F, 11.3F}, {12.6F, 10.2F, 11.3F}, {12.1F, 10.7F, 11.4F}}}}),
                   glm::dmat4(1.0), kWhite)};
  return lights;
}

// Every entry is reached once by the headers' "after", and says what the entries below it say. Broken by: an entry
// more or less anywhere; nodes with one child that have entries; places weighted by area, colours not; no spread;
// extents without the distances between the children.
TEST_F(VplsTest, NodesAreTheirChildrenMerged) {
  for (const EmittingLight& light : treeLights()) {
    SCOPED_TRACE(testing::Message() << light.mesh->triangles.size() << " triangles");
    const LightVoxels& voxels = voxelsOf(light);
    const test::TreeNode root = test::treeOf(voxels);
    std::size_t vpls = 0;
    const std::vector<test::TreeNode> leaves = test::leavesOf(root);
    for (const test::TreeNode& leaf : leaves) vpls += leaf.vpls.size();
    EXPECT_EQ(voxels.tree->cellCount, leaves.size());
    EXPECT_EQ(voxels.tree->vplCount, vpls);
    expectMerged(root);
  }
}

TEST_F(VplsTest, ALightOutsideHasNoRecords) {
  for (const glm::dvec3 at : {glm::dvec3(-40, 4, 5), glm::dvec3(6, 6, 99)}) {
    const LightVoxels& voxels = voxelsOf(test::placed(reference::quad(), test::poseOf(at, glm::dvec3(3.0)), kWhite));
    EXPECT_EQ(voxels.tree->entryCount, 0U);
    EXPECT_EQ(voxels.tree->cellCount, 0U);
  }
}

// Words of the whole tree: on another run, after another light, from the rasterizer. Broken by: entries left in the
// table; bins beyond the 32nd left out of placeOf().
TEST_F(VplsTest, RecordsAreTheSameBits) {
  for (const EmittingLight& light : treeLights()) {
    SCOPED_TRACE(testing::Message() << light.mesh->triangles.size() << " triangles");
    const std::vector<std::uint32_t> bits = test::entryBits(voxelsOf(light));
    EXPECT_FALSE(bits.empty());
    voxelsOf(treeLights()[1]);
    EXPECT_EQ(test::entryBits(voxelsOf(light)), bits);
    rig().plant(kGrid, {light}, InjectionMethod::kRaster);
    EXPECT_EQ(test::entryBits(*rig().voxels[0]), bits);
  }
}

// A table in memory that holds more, and one for which there is no memory yet. Broken by: a table that is not cleared
// before it is filled again; one that does not grow; none of this.
TEST_F(VplsTest, ATableTooSmallIsMadeLarger) {
  const Grid grid = test::unitGrid({40, 40, 40});
  const EmittingLight light =
      test::placed(reference::bumpySphere(4000), test::poseOf(glm::dvec3(20.0), glm::dvec3(30.0)), kWhite);
  rig().plant(grid, {light});
  const std::vector<std::uint32_t> bits = test::entryBits(*rig().voxels[0]);
  const std::uint32_t vpls = rig().voxels[0]->tree->vplCount;
  const std::size_t enough = rig().field->accumulators.size();
  EXPECT_GT(vpls, 1024U) << "to find no room in 256 entries, and in twice as many";
  for (const bool fresh : {false, true}) {
    if (fresh) rig().field = nullptr;
    rig().plant(grid, {light}, InjectionMethod::kCompute, 1);
    EXPECT_EQ(rig().voxels[0]->tree->vplCount, vpls);
    EXPECT_LE(rig().field->accumulators.size(), enough);
    EXPECT_EQ(test::entryBits(*rig().voxels[0]), bits);
  }
}

// In the tree of the light before. Broken by: nodes not cleared; the old box, or the old levels' offsets; the entries
// counted before it left the grid.
TEST_F(VplsTest, AMovedLightFindsItsTreeEmpty) {
  const auto at = [](double x) {
    return test::placed(reference::sphere(), test::poseOf(kCentre + glm::dvec3(x, 0.3 * x, 0.0), glm::dvec3(4.0)),
                        kWhite);
  };
  rig().plant(kGrid, {at(0.0)});
  for (const double x : {0.3, 0.9, 40.0, -1.7}) {
    ASSERT_TRUE(rig().move({at(x)}));
    const std::vector<std::uint32_t> bits = test::entryBits(*rig().voxels[0]);
    const LightVoxelsPtr moved = rig().voxels[0];
    rig().plant(kGrid, {at(x)});
    EXPECT_EQ(test::entryBits(*rig().voxels[0]), bits);
    rig().voxels[0] = moved;
  }
}

// What is left in the table of one light is not found in the next one's. Broken by: keys left in it, or high words.
TEST_F(VplsTest, TheTableIsLeftEmpty) {
  for (const EmittingLight& light : treeLights()) {
    voxelsOf(light);
    for (const std::uint32_t word : test::read<std::uint32_t>(rig().field->accumulators)) ASSERT_EQ(word, 0U);
  }
}

}  // namespace
}  // namespace lpv
