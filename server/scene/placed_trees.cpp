#include "scene/placed_trees.h"

#include <algorithm>
#include <cmath>
#include <glm/gtx/component_wise.hpp>
#include <tuple>
#include <utility>

namespace lpv {

namespace {

/// From the origin, at most: floats of larger coordinates are too coarse for the 2e-4 cells that rays begin above a
/// surface.
constexpr double kMostCells = 512.0;
/// Times an object's longest edge, the most that it may be away from the origin with one triangle: of any number, each
/// then has a thousand steps of a float across it, about.
constexpr double kMostEdges = 1.6e4;

bool finite(const Bounds& box) {
  return std::isfinite(glm::compAdd(glm::abs(box.min))) && std::isfinite(glm::compAdd(glm::abs(box.max)));
}

/// Whether floats about the origin are fine enough for it.
bool fits(const Occluder& o, const Bounds& box, const glm::dvec3& origin, const Grid& grid) {
  const double farthest = glm::compMax(glm::max(glm::abs(box.min - origin), glm::abs(box.max - origin)));
  const double edge = glm::compMax(box.extent()) / std::sqrt(double(o.mesh->triangles.size()));
  return farthest <= kMostCells * grid.cell && farthest <= kMostEdges * edge;
}

/// Of a lattice as wide as the grid, the point that is nearest to its middle.
glm::dvec3 originFor(const Grid& grid) {
  const Bounds box = grid.bounds();
  const double step = std::exp2(std::ceil(std::log2(glm::compMax(box.extent()))));
  return step * glm::round(box.centre() / step);
}

/// Those whose mesh one before them has.
std::vector<bool> sharersOf(const std::vector<Occluder>& occluders) {
  std::vector<std::pair<const Mesh*, std::size_t>> meshes;
  meshes.reserve(occluders.size());
  for (std::size_t i = 0; i < occluders.size(); ++i) meshes.emplace_back(occluders[i].mesh.get(), i);
  std::ranges::sort(meshes);
  std::vector<bool> out(occluders.size());
  for (std::size_t k = 1; k < meshes.size(); ++k) out[meshes[k].second] = meshes[k].first == meshes[k - 1].first;
  return out;
}

float areaOf(const BvhNode& node) {
  const glm::vec3 d = node.upper - node.lower;
  return d.x * d.y + d.y * d.z + d.z * d.x;
}

void include(BvhNode& node, const glm::vec3& lower, const glm::vec3& upper) {
  node.lower = glm::min(node.lower, lower);
  node.upper = glm::max(node.upper, upper);
}

}  // namespace

glm::dmat4 CommonSpace::spaceFromObject(const Occluder& occluder) const {
  glm::dmat4 out = occluder.worldFromObject;
  out[3] -= glm::dvec4(origin, 0.0);
  return out;
}

CommonSpace commonSpaceOf(const std::vector<Occluder>& occluders, const Grid& grid) {
  CommonSpace out = {originFor(grid), {}, {}};
  out.members.reserve(occluders.size());
  out.others.reserve(occluders.size());
  const std::vector<bool> isCopy = sharersOf(occluders);
  std::size_t copied = 0;
  for (std::size_t i = 0; i < occluders.size(); ++i) {
    const Occluder& o = occluders[i];
    const Bounds box = o.mesh->bounds.transformed(o.worldFromObject);
    const bool regular = std::isnormal(glm::determinant(glm::dmat3(o.worldFromObject))) && finite(box);
    const bool stopsAll = o.blocks == kAllLights && o.coverage == Coverage();
    const std::size_t copies = isCopy[i] ? o.mesh->triangles.size() : 0;
    const bool isMember =
        stopsAll && regular && fits(o, box, out.origin, grid) && copied + copies <= kMostCopiedTriangles;
    (isMember ? out.members : out.others).push_back(i);
    if (isMember) copied += copies;
  }
  return out;
}

PlacedTree::PlacedTree(const TriangleBvh& tree, const glm::dmat4& spaceFromObject) : nodes(tree.nodes) {
  const glm::dmat3 turn(spaceFromObject);
  const double side = glm::determinant(turn) < 0.0 ? -1.0 : 1.0;
  const glm::dmat3 ofNormals(side * glm::cross(turn[1], turn[2]), side * glm::cross(turn[2], turn[0]),
                             side * glm::cross(turn[0], turn[1]));
  const auto place = [&](const glm::vec3& p) { return glm::vec3(spaceFromObject * glm::dvec4(glm::dvec3(p), 1.0)); };
  triangles.reserve(tree.triangles.size());
  for (const BvhTriangle& t : tree.triangles) {
    const glm::vec3 n(glm::normalize(ofNormals * glm::dvec3(t.normalX, t.normalY, t.normalZ)));
    triangles.push_back({place(t.first), n.x, place(t.second), n.y, place(t.third), n.z});
  }
  for (std::size_t i = nodes.size(); i-- > 0;) {
    BvhNode& node = nodes[i];
    if (node.items() == 0) {
      const BvhNode &first = nodes[i + 1], &second = nodes[first.skip];
      node.lower = glm::min(first.lower, second.lower);
      node.upper = glm::max(first.upper, second.upper);
      continue;
    }
    node.lower = node.upper = triangles[node.firstItem()].first;
    for (std::uint32_t k = node.firstItem(); k < node.firstItem() + node.items(); ++k) {
      for (const glm::vec3& p : {triangles[k].first, triangles[k].second, triangles[k].third}) include(node, p, p);
    }
    include(node, node.lower - kPlacedBoxMargin * glm::abs(node.lower),
            node.upper + kPlacedBoxMargin * glm::abs(node.upper));
  }
}

std::vector<Subtree> openedTrees(std::span<const std::span<const BvhNode>> trees, std::size_t count) {
  struct Open {
    float area;
    Subtree at;
  };
  const auto later = [](const Open& a, const Open& b) {  // the earlier one of two that are as large is opened first
    return std::tie(a.area, b.at.tree, b.at.node) < std::tie(b.area, a.at.tree, a.at.node);
  };
  std::vector<Open> open;
  std::vector<Subtree> out;
  const auto add = [&](const Subtree& at) {
    const BvhNode& node = trees[at.tree][at.node];
    if (node.items() > 0) {
      out.push_back(at);
      return;
    }
    open.push_back({areaOf(node), at});
    std::ranges::push_heap(open, later);
  };
  for (std::uint32_t tree = 0; tree < trees.size(); ++tree) {
    if (!trees[tree].empty()) add({tree, 0});
  }
  while (!open.empty() && open.size() + out.size() < count) {
    std::ranges::pop_heap(open, later);
    const Subtree at = open.back().at;
    open.pop_back();
    add({at.tree, at.node + 1});
    add({at.tree, trees[at.tree][at.node + 1].skip});
  }
  for (const Open& o : open) out.push_back(o.at);
  std::ranges::sort(
      out, [](const Subtree& a, const Subtree& b) { return std::tie(a.tree, a.node) < std::tie(b.tree, b.node); });
  return out;
}

}  // namespace lpv
