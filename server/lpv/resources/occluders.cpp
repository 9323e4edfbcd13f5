#include "lpv/resources/occluders.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <future>
#include <glm/gtx/component_wise.hpp>
#include <span>

#include "shaders/layout.h"

namespace lpv {

namespace {

using Texel = OccluderTexel;
using Texels = std::vector<Texel>;

template <typename T>
void append(const std::vector<T>& values, Texels& out) {
  const std::size_t at = out.size();
  out.resize(at + values.size() * sizeof(T) / sizeof(Texel));
  if (!values.empty()) std::memcpy(&out[at], values.data(), values.size() * sizeof(T));
}

Texel texelOf(const glm::dvec3& v, double w) { return std::bit_cast<Texel>(glm::vec4(glm::vec3(v), float(w))); }

std::size_t texelsOfTop(const CommonSpace& space) {
  return layout::kOccluderHeader + 2 * kTexelsOfNode * space.others.size() +
         GpuPlacedTrees::texelsAbove(space.members.size()) +
         layout::kInstanceTexels * (space.others.size() + space.members.size());
}

/// The largest coordinate of a mesh's box.
float reachOf(const Mesh& mesh) {
  return float(glm::compMax(glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max))));
}

static_assert(sizeof(Texel) == layout::kAlphasOfTexel);

/// Whether triangles have their texture coordinates beside them.
bool needsUvs(const Occluder& o) { return o.coverage.map != nullptr || o.textured; }

PlacedObjects placedOf(const std::vector<Occluder>& occluders, const CommonSpace& space) {
  PlacedObjects out;
  out.reserve(space.members.size());
  for (const std::size_t i : space.members)
    out.push_back({occluders[i].mesh, space.spaceFromObject(occluders[i]), needsUvs(occluders[i])});
  return out;
}

std::vector<Occluder> othersOf(const std::vector<Occluder>& occluders, const CommonSpace& space) {
  std::vector<Occluder> out;
  for (const std::size_t i : space.others) out.push_back(occluders[i]);
  return out;
}

/// Rows of the matrix from grid space to that of the triangles, where they are, and what of them an instance says.
void appendInstance(const Occluder& o, const glm::dmat4& spaceFromGrid, const StoredTree& tree, float reach,
                    std::uint32_t map, Texels& out) {
  const glm::mat4 rows(glm::transpose(spaceFromGrid));
  for (int row = 0; row < 3; ++row) out.push_back(std::bit_cast<Texel>(rows[row]));
  out.emplace_back(tree.nodes, tree.triangles, std::bit_cast<std::uint32_t>(reach), std::uint32_t(o.blocks));
  const Coverage& c = o.coverage;
  out.push_back(texelOf(c.transmission, c.alpha));
  const glm::uvec2 size(c.map == nullptr ? glm::ivec2(0) : c.map->size);
  out.emplace_back(map, size.x, size.y, tree.uvs);
  out.emplace_back(std::uint32_t(o.surface + 1), std::uint32_t(o.light + 1), std::uint32_t(o.reflects),
                   std::uint32_t(o.shows));
}

/// Nothing is at a point where there is nothing.
Bounds boxAround(const std::vector<Occluder>& occluders, const glm::dmat4& spaceFromWorld) {
  Bounds out;
  for (const Occluder& o : occluders) out.add(o.mesh->bounds.transformed(spaceFromWorld * o.worldFromObject));
  return out.empty() ? Bounds{glm::dvec3(0.0), glm::dvec3(0.0)} : out;
}

Bounds boxAroundLights(std::vector<Occluder> occluders, const Grid& grid) {
  std::erase_if(occluders, [](const Occluder& o) { return o.blocks == kAllLights; });
  return occluders.empty() ? Bounds() : boxAround(occluders, grid.gridFromWorldMatrix());
}

std::size_t texelsOf(const AlphaMap& map) {
  return (map.alphas.size() + layout::kAlphasOfTexel - 1) / layout::kAlphasOfTexel;
}

}  // namespace

/// Takes some time where trees are new.
GpuOccluders::Contents GpuOccluders::contentsOf(const Inputs& inputs, const CommonSpace& space) {
  Contents out;
  for (const std::size_t i : space.others) {
    const Occluder& o = inputs.occluders[i];
    if (!out.meshes.contains(o.mesh)) out.meshes.emplace(o.mesh, bvhOf(o.mesh));
    if (needsUvs(o)) out.withUvs.insert(o.mesh);
    if (o.coverage.map != nullptr) out.maps.insert(o.coverage.map);
  }
  out.placed = placedOf(inputs.occluders, space);
  out.trees = GpuPlacedTrees::make(out.placed);
  return out;
}

bool GpuOccluders::hasMesh(const Occluder& o) const {
  const auto mesh = meshes_.find(o.mesh);
  if (mesh == meshes_.end()) return false;
  if (needsUvs(o) && mesh->second.stored.uvs == 0) return false;
  return o.coverage.map == nullptr || maps_.contains(o.coverage.map);
}

bool GpuOccluders::has(const Inputs& inputs, const CommonSpace& space, const PlacedObjects& placed) const {
  return bool(texels_) && texelsOfTop(space) <= room_ && placed_.has(placed) &&
         std::ranges::all_of(space.others, [&](std::size_t i) { return hasMesh(inputs.occluders[i]); });
}

GpuTask GpuOccluders::store(Contents contents, std::size_t top) {
  meshes_.clear();
  placed_.clear();
  maps_.clear();
  room_ = 0;
  view_ = {};
  texels_ = {};  // first the old memory, then the new
  const std::size_t room = std::bit_ceil(top);
  std::size_t count = room + GpuPlacedTrees::texelsOf(contents.placed, contents.trees);
  for (const auto& [mesh, bvh] : contents.meshes) count += texelsOf(*bvh, contents.withUvs.contains(mesh));
  for (const AlphaMapPtr& map : contents.maps) count += texelsOf(*map);
  texels_ = gpu::Buffer("occluders", count * sizeof(Texel), gpu::BufferUse::kDynamic, gpu::Undefined{});
  view_ = gpu::BufferTexture("occluders", texels_, gpu::BufferTexel::kUvec4);
  std::map<MeshPtr, Place> places;
  std::map<AlphaMapPtr, std::uint32_t> maps;
  std::size_t at = room;
  for (const auto& [mesh, bvh] : contents.meshes) {
    Place& place = places[mesh];
    place.reach = reachOf(*mesh);
    co_await storeTree(texels_, bvh->nodes, bvh->triangles, at, place.stored);
    if (contents.withUvs.contains(mesh)) co_await storeUvs(texels_, *mesh, *bvh, at, place.stored);
  }
  co_await placed_.store(texels_, std::move(contents.placed), std::move(contents.trees), at);
  for (const AlphaMapPtr& map : contents.maps) {
    co_await send(texels_, at, gpu::bytesOf(std::span<const std::uint8_t>(map->alphas)));
    maps[map] = std::uint32_t(at);
    at += texelsOf(*map);
  }
  meshes_ = std::move(places);
  maps_ = std::move(maps);
  room_ = room;
}

void GpuOccluders::storeTop(const Inputs& inputs, const CommonSpace& space) {
  const std::vector<Occluder> others = othersOf(inputs.occluders, space);
  const glm::dmat4 gridFromWorld = inputs.grid.gridFromWorldMatrix(), worldFromGrid = glm::inverse(gridFromWorld);
  const Bvh bvh = bvhOf(others, gridFromWorld);
  const std::size_t above = layout::kOccluderHeader + kTexelsOfNode * bvh.nodes.size();
  const std::size_t instances = above + placed_.texelsAbove();
  const Haze& haze = inputs.haze;
  const Bounds hazy = haze.any() ? haze.box.transformed(gridFromWorld) : Bounds{glm::dvec3(0.0), glm::dvec3(0.0)};
  const Bounds all = boxAround(inputs.occluders, gridFromWorld);
  Texels texels = {
      {std::uint32_t(instances), std::uint32_t(above), std::uint32_t(above + kTexelsOfNode * placed_.nodesAbove()), 0},
      texelOf(hazy.min, haze.extinction * inputs.grid.cell),
      texelOf(hazy.max, 0.0),
      texelOf(inputs.grid.origin - space.origin, inputs.grid.cell),
      texelOf(all.min, 0.0),
      texelOf(all.max, 0.0)};
  texels.reserve(texelsOfTop(space));
  append(bvh.nodes, texels);
  std::vector<std::uint32_t> ofPlaced;
  ofPlaced.reserve(space.members.size());
  for (std::size_t i = 0; i < space.members.size(); ++i)
    ofPlaced.push_back(std::uint32_t(instances + layout::kInstanceTexels * (others.size() + i)));
  placed_.appendAbove(above, ofPlaced, texels);
  for (const std::uint32_t i : bvh.order) {
    const Occluder& o = others[i];
    const Place& place = meshes_.at(o.mesh);
    appendInstance(o, glm::inverse(gridFromWorld * o.worldFromObject), place.stored, place.reach,
                   o.coverage.map == nullptr ? 0 : maps_.at(o.coverage.map), texels);
  }
  const glm::dmat4 spaceFromGrid = glm::translate(glm::dmat4(1.0), -space.origin) * worldFromGrid;
  for (std::size_t i = 0; i < space.members.size(); ++i)
    appendInstance(inputs.occluders[space.members[i]], spaceFromGrid, placed_.tree(i), 0.0F, 0, texels);
  texels_.update(0, gpu::bytesOf(std::span<const Texel>(texels)));
}

GpuTask GpuOccluders::update(std::vector<Occluder> occluders, const Grid& grid, Haze haze) {
  Inputs inputs = {std::move(occluders), haze, grid};
  if (made_.holds(inputs)) co_return;
  const CommonSpace space = commonSpaceOf(inputs.occluders, inputs.grid);
  PlacedObjects placed = placedOf(inputs.occluders, space);
  if (has(inputs, space, placed)) {
    co_await placed_.move(texels_, std::move(placed));
  } else {
    auto contents = std::async(std::launch::async, contentsOf, inputs, space);
    while (contents.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) co_yield yield();
    co_await store(contents.get(), texelsOfTop(space));
  }
  storeTop(inputs, space);
  transparent_ =
      haze.any() || std::ranges::any_of(inputs.occluders, [](const Occluder& o) { return o.coverage != Coverage(); });
  boxOfLights_ = boxAroundLights(inputs.occluders, inputs.grid);
  Inputs all = inputs;
  std::erase_if(all.occluders, [](const Occluder& o) { return o.blocks != kAllLights; });
  if (!surfaces_.holds(all)) surfaces_.set(std::move(all));
  made_.set(std::move(inputs));
}

void GpuOccluders::bind() const { view_.bind(layout::kOccluders); }

}  // namespace lpv
