#pragma once
// Bounding volume hierarchies (BVHs) for shadow rays: boxes in depth-first order, each with the place where to go on
// when it is missed, so that a walk needs no stack (Smits 1998, "Efficiency issues for ray tracing"). Split by the
// surface area heuristic in bins (Wald 2007). The same boxes always give the same tree.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "scene/mesh.h"

namespace lpv {

struct BvhBox {
  glm::vec3 lower{0.0F}, upper{0.0F};
};

/// 32 bytes, as the GPU reads it.
struct BvhNode {
  glm::vec3 lower{0.0F};
  std::uint32_t skip = 0;  ///< the node after this one and all below it
  glm::vec3 upper{0.0F};
  std::uint32_t leaf = 0;  ///< 0: its first child follows; else first item x kLeafItems + number of items, of which a
                           ///< leaf has fewer than kLeafItems
  std::uint32_t firstItem() const;
  std::uint32_t items() const;
};

inline constexpr std::uint32_t kLeafItems = 8;
inline std::uint32_t BvhNode::firstItem() const { return leaf / kLeafItems; }
inline std::uint32_t BvhNode::items() const { return leaf % kLeafItems; }

/// Nodes in depth-first order over items that are put into the order of the leaves.
struct Bvh {
  std::vector<BvhNode> nodes;
  std::vector<std::uint32_t> order;  ///< the given boxes, leaf by leaf
};

/// With at most `itemsOfLeaf` boxes in a leaf, 1..kLeafItems - 1. No nodes without boxes.
Bvh makeBvh(std::span<const BvhBox> boxes, std::uint32_t itemsOfLeaf);

/// A triangle as a ray meets it (Moeller & Trumbore 1997).
struct BvhTriangle {
  glm::vec3 corner{0.0F};
  std::uint32_t index = 0;  ///< in the mesh
  glm::vec3 first{0.0F};    ///< edge from the corner to the second one
  std::uint32_t pad0 = 0;
  glm::vec3 second{0.0F};   ///< edge from the corner to the third one
  std::uint32_t pad1 = 0;
};

/// A mesh's triangles with area, object space.
struct TriangleBvh {
  explicit TriangleBvh(const Mesh& mesh);
  std::vector<BvhNode> nodes;  ///< none where no triangle has area
  std::vector<BvhTriangle> triangles;
};
using TriangleBvhPtr = std::shared_ptr<const TriangleBvh>;

/// The mesh's BVH, made at the first call and kept while the mesh is there: some 50 ms for 100,000 triangles.
/// Thread-safe.
TriangleBvhPtr bvhOf(const MeshPtr& mesh);

/// Whether the segment from `from` to `to` meets a triangle strictly in between, from either side. In the mesh's space.
bool meets(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to);

/// Whether the segment meets a node's box; `inverse`: 1 / (to - from) per axis.
bool meets(const BvhNode& node, const glm::dvec3& from, const glm::dvec3& inverse);

}  // namespace lpv
