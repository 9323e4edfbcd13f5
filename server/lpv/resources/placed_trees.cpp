#include "lpv/resources/placed_trees.h"

#include <array>
#include <bit>
#include <chrono>
#include <future>
#include <utility>

namespace lpv {

namespace {

/// Subtrees that trees are opened into, besides one for each. A walk through the living room's 38 objects, 180,000
/// triangles, meets 53 nodes with none, 38 with 256 and again more with 1,024.
constexpr std::size_t kOpened = 256;
constexpr std::size_t kTexelsAbove = kTexelsOfNode + 1;  // of a node: itself, and whose triangles it has

static_assert(kPlacedBoxMargin == layout::kBoxMargin);

/// As shaders read them: with texels of the buffer for places in the tree.
std::vector<BvhNode> inBuffer(std::span<const BvhNode> nodes, const StoredTree& tree) {
  std::vector<BvhNode> out(nodes.begin(), nodes.end());
  for (BvhNode& node : out) {
    node.skip = tree.nodes + std::uint32_t(kTexelsOfNode) * node.skip;
    if (node.items() == 0) continue;
    node.leaf = (tree.triangles + layout::kTriangleTexels * node.firstItem()) * kLeafItems + node.items();
  }
  return out;
}

}  // namespace

MadeTrees GpuPlacedTrees::make(const PlacedObjects& objects) {
  MadeTrees out;
  for (const PlacedObject& o : objects) {
    const TriangleBvhPtr bvh = bvhOf(o.mesh);
    out.push_back({bvh, PlacedTree(*bvh, o.spaceFromObject)});
  }
  return out;
}

std::size_t GpuPlacedTrees::texelsOf(const PlacedObjects& objects, const MadeTrees& trees) {
  std::size_t out = 0;
  for (std::size_t i = 0; i < objects.size(); ++i) out += lpv::texelsOf(*trees[i].bvh, objects[i].withUvs);
  return out;
}

std::size_t GpuPlacedTrees::texelsAbove(std::size_t objects) {
  return objects == 0 ? 0 : 2 * kTexelsAbove * (objects + kOpened);
}

std::optional<std::vector<std::size_t>> GpuPlacedTrees::placesOf(const PlacedObjects& objects) const {
  std::vector<std::size_t> out;
  std::map<MeshPtr, std::size_t> taken;
  for (const PlacedObject& o : objects) {
    const auto found = byMesh_.find(o.mesh);
    const std::size_t next = taken[o.mesh]++;
    if (found == byMesh_.end() || next >= found->second.size()) return std::nullopt;
    const std::size_t place = found->second[next];
    if (o.withUvs && places_[place].stored.uvs == 0) return std::nullopt;
    out.push_back(place);
  }
  return out;
}

bool GpuPlacedTrees::has(const PlacedObjects& objects) const {
  return objects_ == objects || placesOf(objects).has_value();
}

void GpuPlacedTrees::clear() { *this = {}; }

GpuTask GpuPlacedTrees::put(gpu::Buffer& buffer, PlacedTree tree, const glm::dmat4& spaceFromObject, Place& place) {
  place.spaceFromObject.reset();
  const std::vector<BvhNode> nodes = inBuffer(tree.nodes, place.stored);
  std::size_t at = place.stored.nodes;
  co_await storeTree(buffer, nodes, tree.triangles, at, place.stored);
  place.nodes = std::move(tree.nodes);
  place.spaceFromObject = spaceFromObject;
}

GpuTask GpuPlacedTrees::store(gpu::Buffer& buffer, PlacedObjects objects, MadeTrees trees, std::size_t& at) {
  clear();
  for (std::size_t i = 0; i < objects.size(); ++i) {
    Place place = {objects[i].mesh, {}, {}, {}};
    place.stored = {std::uint32_t(at), std::uint32_t(at + kTexelsOfNode * trees[i].placed.nodes.size()), 0};
    at = place.stored.triangles + layout::kTriangleTexels * trees[i].placed.triangles.size();
    co_await put(buffer, std::move(trees[i].placed), objects[i].spaceFromObject, place);
    if (objects[i].withUvs) co_await storeUvs(buffer, *objects[i].mesh, *trees[i].bvh, at, place.stored);
    byMesh_[objects[i].mesh].push_back(i);
    members_.push_back(i);
    places_.push_back(std::move(place));
  }
  makeAbove();
  objects_ = std::move(objects);
}

GpuTask GpuPlacedTrees::move(gpu::Buffer& buffer, PlacedObjects objects) {
  if (objects_ == objects) co_return;
  objects_.reset();
  const std::vector<std::size_t> members = placesOf(objects).value();
  PlacedObjects moved;
  std::vector<std::size_t> to;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (places_[members[i]].spaceFromObject == objects[i].spaceFromObject) continue;
    moved.push_back(objects[i]);
    to.push_back(members[i]);
  }
  MadeTrees trees;
  if (!moved.empty()) {
    auto made = std::async(std::launch::async, make, moved);
    while (made.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) co_yield yield();
    trees = made.get();
  }
  for (std::size_t i = 0; i < moved.size(); ++i)
    co_await put(buffer, std::move(trees[i].placed), moved[i].spaceFromObject, places_[to[i]]);
  members_ = members;
  makeAbove();
  objects_ = std::move(objects);
}

void GpuPlacedTrees::makeAbove() {
  std::vector<std::span<const BvhNode>> trees;
  for (const std::size_t member : members_) trees.emplace_back(places_[member].nodes);
  subtrees_ = openedTrees(trees, members_.size() + kOpened);
  std::vector<BvhBox> boxes;
  for (const Subtree& s : subtrees_) boxes.push_back({trees[s.tree][s.node].lower, trees[s.tree][s.node].upper});
  above_ = makeBvh(boxes, 1);
}

std::size_t GpuPlacedTrees::texelsAbove() const { return kTexelsAbove * above_.nodes.size(); }

void GpuPlacedTrees::appendAbove(std::size_t at, std::span<const std::uint32_t> instances,
                                 std::vector<OccluderTexel>& out) const {
  std::vector<OccluderTexel> owners;
  for (BvhNode node : above_.nodes) {
    if (node.items() == 0) {
      node.skip = std::uint32_t(at + kTexelsOfNode * node.skip);
      owners.emplace_back(0);
    } else {
      const Subtree& s = subtrees_[above_.order[node.firstItem()]];
      const Place& place = places_[members_[s.tree]];
      node.skip = place.stored.nodes + std::uint32_t(kTexelsOfNode) * place.nodes[s.node].skip;
      node.leaf = (place.stored.nodes + std::uint32_t(kTexelsOfNode) * s.node) * kLeafItems;
      owners.emplace_back(instances[s.tree], place.stored.triangles, 0, 0);
    }
    const auto texels = std::bit_cast<std::array<OccluderTexel, kTexelsOfNode>>(node);
    out.insert(out.end(), texels.begin(), texels.end());
  }
  out.insert(out.end(), owners.begin(), owners.end());
}

}  // namespace lpv
