#pragma once
// Bounding volume hierarchies (BVHs) for shadow rays: boxes in depth-first order, each with the place where to go on
// when it is missed, so that a walk needs no stack (Smits 1998, "Efficiency issues for ray tracing"). Split by the
// surface area heuristic in bins (Wald 2007). The same boxes always give the same tree.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
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

/// A triangle as a segment meets it. The corners as the mesh has them, so that triangles which share an edge agree
/// about the side on which a segment passes it; the normal, since that of a long, thin one is lost in floats.
struct BvhTriangle {
  glm::vec3 first{0.0F};
  float normalX = 0.0F;  ///< unit, (second - first) x (third - first)
  glm::vec3 second{0.0F};
  float normalY = 0.0F;
  glm::vec3 third{0.0F};
  float normalZ = 0.0F;
};

/// A mesh's triangles with area, object space.
struct TriangleBvh {
  explicit TriangleBvh(const Mesh& mesh);
  std::vector<BvhNode> nodes;  ///< none where no triangle has area
  std::vector<BvhTriangle> triangles;
  std::vector<std::uint32_t> indices;  ///< of each, in the mesh
};
using TriangleBvhPtr = std::shared_ptr<const TriangleBvh>;

/// The mesh's BVH, made at the first call and kept while the mesh is there: some 50 ms for 100,000 triangles.
/// Thread-safe.
TriangleBvhPtr bvhOf(const MeshPtr& mesh);

/// A segment as boxes and triangles are tested against it, in double. Triangles after Woop, Benthin and Wald 2013,
/// "Watertight ray/triangle intersection": seen along the segment, whose plane is any here, the side on which it passes
/// an edge is the same for both triangles that have the edge.
class BvhSegment {
 public:
  BvhSegment(const glm::dvec3& from, const glm::dvec3& to);

  bool meets(const BvhNode& node) const;
  /// Strictly between the ends, from either side. Not from within the triangle's plane.
  bool meets(const BvhTriangle& triangle) const;
  /// The same with the weights of the corners where it meets; nothing where it does not. Of triangles that share an
  /// edge or a corner, and that the segment goes through one after the other, one alone says that it was met there: so
  /// that a pane of two triangles is one pane.
  std::optional<glm::dvec3> crossing(const BvhTriangle& triangle) const;
  /// Where on the segment it meets, 0..1; nothing where it does not.
  std::optional<double> where(const BvhTriangle& triangle) const;

 private:
  /// A triangle as it is seen along the segment.
  struct Seen {
    glm::dvec3 first, second, third;  ///< corners, from the segment's start
    glm::dvec2 a, b, c;  ///< across the segment
    glm::dvec3 sides;  ///< on which the segment passes the edges across from the corners
    bool near() const;
  };
  Seen seen(const BvhTriangle& triangle) const;
  bool isInside(const Seen& t) const;
  double planeAt(const Seen& t) const;

  glm::dvec3 from_, direction_, inverse_;
  glm::dvec3 right_, up_;  ///< across the segment
};

/// Whether the segment from `from` to `to` meets a triangle strictly in between, from either side. In the mesh's space.
bool meets(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to);

struct BvhHit {
  double at = 1.0;  ///< on the segment, 0..1
  std::uint32_t triangle = 0;  ///< in TriangleBvh::triangles
  bool front = true;  ///< its corners are seen counter-clockwise
};
/// The first that it meets.
std::optional<BvhHit> firstHit(const TriangleBvh& bvh, const glm::dvec3& from, const glm::dvec3& to);

}  // namespace lpv
