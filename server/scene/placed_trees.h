#pragma once
// Trees over the triangles of surfaces that stop all light, in one space: a ray walks through them as through one tree,
// and is taken into the space of no object. Where objects stand within each other's boxes their trees are opened: the
// tree above is one over subtrees (partial re-braiding: Benthin, Woop, Wald and Afra 2017, "Improved two-level BVHs
// using partial re-braiding").

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "scene/grid.h"
#include "scene/occluders.h"
#include "scene/triangle_bvh.h"

namespace lpv {

/// Which occluders of a scene have trees in one space, metres: world space about `origin`.
struct CommonSpace {
  glm::dvec3 origin{0.0};
  std::vector<std::size_t> members;  ///< among the occluders, ascending
  std::vector<std::size_t> others;  ///< those that stay in their own spaces, ascending

  glm::dmat4 spaceFromObject(const Occluder& occluder) const;
};

/// Triangles that are kept more than once, since several objects share their mesh, at most: what is beyond stays in its
/// own space.
inline constexpr std::size_t kMostCopiedTriangles = 1 << 18;

/// Members are surfaces that stop all light and whose triangles floats of the space can tell apart: they are not far
/// from the grid, and not small for where they are. The origin is near to the grid's middle, and stays where it is
/// while that moves a little.
CommonSpace commonSpaceOf(const std::vector<Occluder>& occluders, const Grid& grid);

/// Of coordinates: what boxes are larger by.
inline constexpr float kPlacedBoxMargin = 1e-6F;

/// A mesh's tree where an object stands: the nodes and triangles of `TriangleBvh`, in its order. Boxes are larger than
/// what they hold by what a test in floats may lose of their coordinates. Normals are on the same sides of triangles as
/// the mesh's, mirrored or not.
struct PlacedTree {
  PlacedTree() = default;
  PlacedTree(const TriangleBvh& tree, const glm::dmat4& spaceFromObject);
  std::vector<BvhNode> nodes;
  std::vector<BvhTriangle> triangles;
};

/// A node of one of several trees, and all below it.
struct Subtree {
  std::uint32_t tree = 0, node = 0;
  bool operator==(const Subtree&) const = default;
};

/// Subtrees that have all that is in the trees, each triangle once: `count` of them where that many can be had, and at
/// least one for each tree with nodes. Those with the largest boxes are opened. In the order of trees and nodes.
std::vector<Subtree> openedTrees(std::span<const std::span<const BvhNode>> trees, std::size_t count);

}  // namespace lpv
