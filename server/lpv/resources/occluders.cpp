#include "lpv/resources/occluders.h"

#include <algorithm>
#include <bit>
#include <chrono>
#include <cstring>
#include <future>
#include <glm/gtx/component_wise.hpp>
#include <span>

#include "lpv/pacing/chunked.h"
#include "shaders/layout.h"

namespace lpv {

namespace {

using Texel = glm::uvec4;
using Texels = std::vector<Texel>;

constexpr std::size_t kTexelsOfNode = sizeof(BvhNode) / sizeof(Texel);
static_assert(sizeof(BvhNode) == 32 && sizeof(BvhTriangle) == layout::kTriangleTexels * sizeof(Texel));
static_assert(kLeafItems == layout::kLeafItems);

template <typename T>
void append(const std::vector<T>& values, Texels& out) {
  const std::size_t at = out.size();
  out.resize(at + values.size() * sizeof(T) / sizeof(Texel));
  if (!values.empty()) std::memcpy(&out[at], values.data(), values.size() * sizeof(T));
}

std::size_t texelsOfTop(std::size_t instances) {
  return layout::kOccluderHeader + 2 * kTexelsOfNode * instances + layout::kInstanceTexels * instances;
}

std::size_t texelsOf(const TriangleBvh& bvh) {
  return kTexelsOfNode * bvh.nodes.size() + layout::kTriangleTexels * bvh.triangles.size();
}

/// The largest coordinate of a mesh's box.
float reachOf(const Mesh& mesh) {
  return float(glm::compMax(glm::max(glm::abs(mesh.bounds.min), glm::abs(mesh.bounds.max))));
}

/// Some megabytes at a time.
GpuTask send(gpu::Buffer& buffer, std::size_t texel, std::span<const std::byte> bytes) {
  for (const Chunk& part : chunksOf(bytes.size())) {
    buffer.update(texel * sizeof(Texel) + part.offset, bytes.subspan(part.offset, part.bytes));
    co_yield yield();
  }
}

/// Texture coordinates of triangles in the order of the tree.
std::vector<glm::vec2> uvsOf(const Mesh& mesh, const TriangleBvh& bvh) {
  std::vector<glm::vec2> out;
  out.reserve(4 * bvh.indices.size());
  for (const std::uint32_t i : bvh.indices) {
    const glm::uvec3& t = mesh.triangles[i];
    out.insert(out.end(), {mesh.uvs[t.x], mesh.uvs[t.y], mesh.uvs[t.z], glm::vec2(0.0F)});
  }
  return out;
}
static_assert(4 * sizeof(glm::vec2) == layout::kUvTexels * sizeof(Texel));
static_assert(sizeof(Texel) == layout::kAlphasOfTexel);

Bounds boxAroundLights(const std::vector<Occluder>& occluders, const Grid& grid) {
  Bounds out;
  for (const Occluder& o : occluders) {
    if (o.blocks == kAllLights) continue;
    out.add(o.mesh->bounds.transformed(grid.gridFromWorldMatrix() * o.worldFromObject));
  }
  return out;
}

std::size_t texelsOf(const AlphaMap& map) {
  return (map.alphas.size() + layout::kAlphasOfTexel - 1) / layout::kAlphasOfTexel;
}

}  // namespace

/// Takes some time where trees are new.
GpuOccluders::Contents GpuOccluders::contentsOf(const std::vector<Occluder>& occluders) {
  Contents out;
  for (const Occluder& o : occluders) {
    if (!out.meshes.contains(o.mesh)) out.meshes.emplace(o.mesh, bvhOf(o.mesh));
    if (o.coverage.map != nullptr || o.textured) out.withUvs.insert(o.mesh);
    if (o.coverage.map != nullptr) out.maps.insert(o.coverage.map);
  }
  return out;
}

bool GpuOccluders::has(const Occluder& o) const {
  const auto mesh = meshes_.find(o.mesh);
  if (mesh == meshes_.end()) return false;
  if ((o.coverage.map != nullptr || o.textured) && mesh->second.uvs == 0) return false;
  return o.coverage.map == nullptr || maps_.contains(o.coverage.map);
}

GpuTask GpuOccluders::storeMesh(const MeshPtr& mesh, const TriangleBvh& bvh, bool withUvs, std::size_t& at,
                                Place& place) {
  const std::size_t triangles = at + bvh.nodes.size() * kTexelsOfNode;
  place = {std::uint32_t(at), std::uint32_t(triangles), reachOf(*mesh), 0};
  co_await send(texels_, at, gpu::bytesOf(std::span<const BvhNode>(bvh.nodes)));
  co_await send(texels_, triangles, gpu::bytesOf(std::span<const BvhTriangle>(bvh.triangles)));
  at += texelsOf(bvh);
  if (!withUvs) co_return;
  const std::vector<glm::vec2> uvs = uvsOf(*mesh, bvh);
  co_await send(texels_, at, gpu::bytesOf(std::span<const glm::vec2>(uvs)));
  place.uvs = std::uint32_t(at);
  at += layout::kUvTexels * bvh.triangles.size();
}

GpuTask GpuOccluders::store(Contents contents, std::size_t top) {
  meshes_.clear();
  maps_.clear();
  room_ = 0;
  view_ = {};
  texels_ = {};  // first the old memory, then the new
  const std::size_t room = std::bit_ceil(top);
  std::size_t count = room;
  for (const auto& [mesh, bvh] : contents.meshes) {
    count += texelsOf(*bvh);
    if (contents.withUvs.contains(mesh)) count += layout::kUvTexels * bvh->triangles.size();
  }
  for (const AlphaMapPtr& map : contents.maps) count += texelsOf(*map);
  texels_ = gpu::Buffer("occluders", count * sizeof(Texel), gpu::BufferUse::kDynamic, gpu::Undefined{});
  view_ = gpu::BufferTexture("occluders", texels_, gpu::BufferTexel::kUvec4);
  std::map<MeshPtr, Place> places;
  std::map<AlphaMapPtr, std::uint32_t> maps;
  std::size_t at = room;
  for (const auto& [mesh, bvh] : contents.meshes)
    co_await storeMesh(mesh, *bvh, contents.withUvs.contains(mesh), at, places[mesh]);
  for (const AlphaMapPtr& map : contents.maps) {
    co_await send(texels_, at, gpu::bytesOf(std::span<const std::uint8_t>(map->alphas)));
    maps[map] = std::uint32_t(at);
    at += texelsOf(*map);
  }
  meshes_ = std::move(places);
  maps_ = std::move(maps);
  room_ = room;
}

void GpuOccluders::storeTop(const Inputs& inputs) {
  const Bvh bvh = bvhOf(inputs.occluders, inputs.grid.gridFromWorldMatrix());
  const std::size_t nodes = layout::kOccluderHeader + kTexelsOfNode * bvh.nodes.size();
  const Haze& haze = inputs.haze;
  const Bounds box =
      haze.any() ? haze.box.transformed(inputs.grid.gridFromWorldMatrix()) : Bounds{glm::dvec3(0.0), glm::dvec3(0.0)};
  Texels texels = {{std::uint32_t(nodes), 0, 0, 0},
                   std::bit_cast<Texel>(glm::vec4(glm::vec3(box.min), float(haze.extinction * inputs.grid.cell))),
                   std::bit_cast<Texel>(glm::vec4(glm::vec3(box.max), 0.0F))};
  append(bvh.nodes, texels);
  for (const std::uint32_t i : bvh.order) {
    const Occluder& o = inputs.occluders[i];
    const glm::dmat4 objectFromGrid = glm::inverse(inputs.grid.gridFromWorldMatrix() * o.worldFromObject);
    const glm::mat4 rows(glm::transpose(objectFromGrid));
    for (int row = 0; row < 3; ++row) texels.push_back(std::bit_cast<Texel>(rows[row]));
    const Place& place = meshes_.at(o.mesh);
    texels.emplace_back(place.nodes, place.triangles, std::bit_cast<std::uint32_t>(place.reach),
                        std::uint32_t(o.blocks));
    const Coverage& c = o.coverage;
    texels.push_back(std::bit_cast<Texel>(glm::vec4(glm::vec3(c.transmission), float(c.alpha))));
    const glm::uvec2 size(c.map == nullptr ? glm::ivec2(0) : c.map->size);
    texels.emplace_back(c.map == nullptr ? 0U : maps_.at(c.map), size.x, size.y, place.uvs);
    texels.emplace_back(std::uint32_t(o.surface + 1), std::uint32_t(o.light + 1), std::uint32_t(o.reflects), 0);
  }
  texels_.update(0, gpu::bytesOf(std::span<const Texel>(texels)));
}

GpuTask GpuOccluders::update(std::vector<Occluder> occluders, const Grid& grid, Haze haze) {
  Inputs inputs = {std::move(occluders), haze, grid};
  if (made_.holds(inputs)) co_return;
  const std::size_t top = texelsOfTop(inputs.occluders.size());
  const bool known = bool(texels_) && top <= room_ &&
                     std::ranges::all_of(inputs.occluders, [this](const Occluder& o) { return has(o); });
  if (!known) {
    auto contents = std::async(std::launch::async, contentsOf, inputs.occluders);
    while (contents.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) co_yield yield();
    co_await store(contents.get(), top);
  }
  storeTop(inputs);
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
