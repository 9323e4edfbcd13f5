// Trees of surfaces in one space against the meshes that they are of.
#include "scene/placed_trees.h"

#include <gtest/gtest.h>

#include "reference/meshes.h"

namespace lpv {
namespace {

const Grid kGrid = {glm::dvec3(-2), 0.125, glm::ivec3(32)};

Transform standing(const glm::dvec3& at, const glm::dvec3& scale) {
  return {at, glm::angleAxis(0.7, glm::normalize(glm::dvec3(1, 2, 3))), scale};
}

Occluder occluder(const MeshPtr& mesh, const Transform& transform) {
  return {mesh, transform.worldFromObject(), kAllLights, {}};
}

bool holds(const BvhNode& node, const glm::vec3& p) {
  return glm::all(glm::lessThanEqual(node.lower, p)) && glm::all(glm::lessThanEqual(p, node.upper));
}

// Red where boxes are those of the mesh turned, or only of a leaf's first triangle.
TEST(PlacedTree, HasTheMeshsTrianglesInItsBoxes) {
  const MeshPtr mesh = reference::bumpySphere(2000);
  const TriangleBvhPtr bvh = bvhOf(mesh);
  const glm::dmat4 m = standing({3, -1, 2}, {0.5, 2, 1}).worldFromObject();
  const PlacedTree tree(*bvh, m);
  ASSERT_EQ(tree.nodes.size(), bvh->nodes.size());
  ASSERT_EQ(tree.triangles.size(), bvh->triangles.size());
  for (std::size_t i = 0; i < tree.triangles.size(); ++i) {
    const auto corner = [&](const glm::vec3& p) { return glm::vec3(m * glm::dvec4(glm::dvec3(p), 1.0)); };
    EXPECT_EQ(tree.triangles[i].second, corner(bvh->triangles[i].second));
    EXPECT_EQ(tree.triangles[i].third, corner(bvh->triangles[i].third));
  }
  for (std::size_t at = 0; at < tree.nodes.size(); ++at) {
    const BvhNode& node = tree.nodes[at];
    EXPECT_EQ(node.skip, bvh->nodes[at].skip);
    EXPECT_EQ(node.leaf, bvh->nodes[at].leaf);
    for (std::size_t below = at; below < node.skip; ++below) {
      for (std::uint32_t i = 0; i < tree.nodes[below].items(); ++i) {
        const BvhTriangle& t = tree.triangles[tree.nodes[below].firstItem() + i];
        ASSERT_TRUE(holds(node, t.first) && holds(node, t.second) && holds(node, t.third)) << at;
      }
    }
  }
}

// A ray meets the front of a triangle of a mirrored object where it met the front of the mesh's. Red with the normal of
// the placed corners, and with one that is turned as positions are.
TEST(PlacedTree, KeepsTheSidesOfTriangles) {
  const TriangleBvhPtr bvh = bvhOf(reference::bumpySphere(500));
  for (const glm::dvec3& scale : {glm::dvec3(1, 4, 0.5), glm::dvec3(-1, 4, 0.5), glm::dvec3(-1, -2, -3)}) {
    const glm::dmat4 m = standing(glm::dvec3(0), scale).worldFromObject();
    const glm::dmat3 backwards = glm::transpose(glm::inverse(glm::dmat3(m)));
    const PlacedTree tree(*bvh, m);
    for (std::size_t i = 0; i < tree.triangles.size(); ++i) {
      const BvhTriangle &before = bvh->triangles[i], &after = tree.triangles[i];
      const glm::dvec3 want = glm::normalize(backwards * glm::dvec3(before.normalX, before.normalY, before.normalZ));
      EXPECT_LT(glm::distance(want, glm::dvec3(after.normalX, after.normalY, after.normalZ)), 1e-5) << i;
    }
  }
}

std::size_t trianglesBelow(std::span<const BvhNode> nodes, std::uint32_t at) {
  std::size_t out = 0;
  for (std::uint32_t i = at; i < nodes[at].skip; ++i) out += nodes[i].items();
  return out;
}

// Red where a node that is opened stays in the list, and where its second child is taken for the first one's.
TEST(OpenedTrees, HaveEveryTriangleOnce) {
  const std::vector<MeshPtr> meshes = {reference::bumpySphere(3000), reference::quad(), reference::pyramid()};
  std::vector<std::span<const BvhNode>> trees;
  std::size_t all = 0;
  for (const MeshPtr& mesh : meshes) {
    trees.emplace_back(bvhOf(mesh)->nodes);
    all += bvhOf(mesh)->triangles.size();
  }
  for (const std::size_t count : {0, 3, 4, 20, 500, 100000}) {
    const std::vector<Subtree> subtrees = openedTrees(trees, count);
    std::size_t found = 0;
    for (std::size_t i = 0; i < subtrees.size(); ++i) {
      const Subtree& s = subtrees[i];
      found += trianglesBelow(trees[s.tree], s.node);
      if (i == 0 || subtrees[i - 1].tree != s.tree) continue;
      EXPECT_GE(s.node, trees[s.tree][subtrees[i - 1].node].skip) << "within the one before";
    }
    EXPECT_EQ(found, all) << count;
    if (count > 3 && count < 1000) {
      EXPECT_EQ(subtrees.size(), count);
    }
    EXPECT_EQ(subtrees, openedTrees(trees, count));
  }
}

// Red where small boxes are opened first.
TEST(OpenedTrees, OpenWhatIsLargest) {
  const TriangleBvhPtr bvh = bvhOf(reference::bumpySphere(500));
  const PlacedTree large(*bvh, standing(glm::dvec3(0), glm::dvec3(10)).worldFromObject());
  const PlacedTree small(*bvh, standing(glm::dvec3(0), glm::dvec3(0.1)).worldFromObject());
  const std::vector<std::span<const BvhNode>> trees = {small.nodes, large.nodes};
  const std::vector<Subtree> subtrees = openedTrees(trees, 12);
  ASSERT_EQ(subtrees.size(), 12U);
  EXPECT_EQ(subtrees[0], (Subtree{0, 0}));
  EXPECT_EQ(subtrees[1].tree, 1U);
}

TEST(CommonSpace, HasWhatStopsAllLightNearTheGrid) {
  const MeshPtr box = reference::box(glm::dvec3(-1), glm::dvec3(1)), statue = reference::bumpySphere(20000);
  std::vector<Occluder> all;
  const auto add = [&](const char* what, bool isMember, Occluder o) {
    all.push_back(std::move(o));
    const CommonSpace space = commonSpaceOf(all, kGrid);
    EXPECT_EQ(std::ranges::count(space.members, all.size() - 1), isMember ? 1 : 0) << what;
    EXPECT_EQ(space.members.size() + space.others.size(), all.size()) << what;
  };
  add("a box", true, occluder(box, standing({1, 0, 0}, glm::dvec3(1))));
  add("a mirrored one", true, occluder(box, standing({1, 0, 0}, {-1, 1, 1})));
  add("a statue", true, occluder(statue, standing({0, 1, 0}, glm::dvec3(1))));
  add("a statue of a millimetre", false, occluder(statue, standing({0, 1, 0}, glm::dvec3(1e-3))));
  add("a box of a millimetre", true, occluder(box, standing({0, 1, 0}, glm::dvec3(1e-3))));
  add("a box that is far away", false, occluder(box, standing({100, 0, 0}, glm::dvec3(1))));
  add("a floor beyond the grid", false, occluder(box, standing({0, 0, 0}, {1000, 1, 1000})));
  add("a flattened box", false, occluder(box, standing({0, 0, 0}, {1, 0, 1})));
  Occluder lamp = occluder(box, {});
  lamp.blocks = kFromSurfaces;
  add("a lamp", false, lamp);
  Occluder pane = occluder(box, {});
  pane.coverage.alpha = 0.5;
  add("a pane", false, pane);
}

// Red where the space follows the grid's corner: each step would place all again.
TEST(CommonSpace, StaysWhereItIsWhileTheGridMovesALittle) {
  Grid grid = kGrid;
  const glm::dvec3 before = commonSpaceOf({}, grid).origin;
  grid.origin += 0.3;
  EXPECT_EQ(commonSpaceOf({}, grid).origin, before);
  grid.origin += 1e6;
  EXPECT_LT(glm::distance(commonSpaceOf({}, grid).origin, grid.bounds().centre()), 4.0);
}

TEST(CommonSpace, HasFewCopiesOfLargeMeshes) {
  const MeshPtr statue = reference::bumpySphere(100000);
  const std::size_t copies = kMostCopiedTriangles / statue->triangles.size();
  std::vector<Occluder> all(copies + 5, occluder(statue, {}));
  const CommonSpace space = commonSpaceOf(all, kGrid);
  EXPECT_EQ(space.members.size(), 1 + copies);
  EXPECT_EQ(space.others.size(), 4U);
}

}  // namespace
}  // namespace lpv
