#include "lpv/resources/occluders.h"

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
  return 1 + 2 * kTexelsOfNode * instances + layout::kInstanceTexels * instances;
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

std::map<MeshPtr, TriangleBvhPtr> bvhsOf(const std::vector<MeshPtr>& meshes) {
  std::map<MeshPtr, TriangleBvhPtr> out;
  for (const MeshPtr& mesh : meshes) {
    if (!out.contains(mesh)) out.emplace(mesh, bvhOf(mesh));
  }
  return out;
}

}  // namespace

GpuTask GpuOccluders::storeMeshes(std::map<MeshPtr, TriangleBvhPtr> meshes, std::size_t top) {
  meshes_.clear();
  room_ = 0;
  view_ = {};
  texels_ = {};  // first the old memory, then the new
  const std::size_t room = std::bit_ceil(top);
  std::size_t count = room;
  for (const auto& [mesh, bvh] : meshes) count += texelsOf(*bvh);
  texels_ = gpu::Buffer("occluders", count * sizeof(Texel), gpu::BufferUse::kDynamic, gpu::Undefined{});
  view_ = gpu::BufferTexture("occluders", texels_, gpu::BufferTexel::kUvec4);
  std::map<MeshPtr, Place> places;
  std::size_t at = room;
  for (const auto& [mesh, bvh] : meshes) {
    const std::size_t triangles = at + bvh->nodes.size() * kTexelsOfNode;
    places[mesh] = {std::uint32_t(at), std::uint32_t(triangles), reachOf(*mesh)};
    co_await send(texels_, at, gpu::bytesOf(std::span<const BvhNode>(bvh->nodes)));
    co_await send(texels_, triangles, gpu::bytesOf(std::span<const BvhTriangle>(bvh->triangles)));
    at += texelsOf(*bvh);
  }
  meshes_ = std::move(places);
  room_ = room;
}

void GpuOccluders::storeTop(const Inputs& inputs) {
  const Bvh bvh = bvhOf(inputs.occluders, inputs.grid.gridFromWorldMatrix());
  Texels texels = {{std::uint32_t(1 + kTexelsOfNode * bvh.nodes.size()), 0, 0, 0}};
  append(bvh.nodes, texels);
  for (const std::uint32_t i : bvh.order) {
    const Occluder& o = inputs.occluders[i];
    const glm::dmat4 objectFromGrid = glm::inverse(inputs.grid.gridFromWorldMatrix() * o.worldFromObject);
    const glm::mat4 rows(glm::transpose(objectFromGrid));
    for (int row = 0; row < 3; ++row) texels.push_back(std::bit_cast<Texel>(rows[row]));
    const Place& place = meshes_.at(o.mesh);
    texels.emplace_back(place.nodes, place.triangles, std::bit_cast<std::uint32_t>(place.reach),
                        std::uint32_t(o.blocks));
  }
  texels_.update(0, gpu::bytesOf(std::span<const Texel>(texels)));
}

GpuTask GpuOccluders::update(std::vector<Occluder> occluders, const Grid& grid) {
  Inputs inputs = {std::move(occluders), grid};
  if (made_.holds(inputs)) co_return;
  bool known = bool(texels_) && texelsOfTop(inputs.occluders.size()) <= room_;
  std::vector<MeshPtr> meshes;
  for (const Occluder& o : inputs.occluders) {
    meshes.push_back(o.mesh);
    known = known && meshes_.contains(o.mesh);
  }
  if (!known) {
    auto trees = std::async(std::launch::async, bvhsOf, std::move(meshes));
    while (trees.wait_for(std::chrono::microseconds(200)) != std::future_status::ready) co_yield yield();
    co_await storeMeshes(trees.get(), texelsOfTop(inputs.occluders.size()));
  }
  storeTop(inputs);
  Inputs all = inputs;
  std::erase_if(all.occluders, [](const Occluder& o) { return o.blocks != kAllLights; });
  if (!surfaces_.holds(all)) surfaces_.set(std::move(all));
  made_.set(std::move(inputs));
}

void GpuOccluders::bind() const { view_.bind(layout::kOccluders); }

}  // namespace lpv
