#include "lpv/resources/occluders.h"

#include <bit>
#include <chrono>
#include <cstring>
#include <future>
#include <glm/gtx/component_wise.hpp>
#include <span>

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

std::map<MeshPtr, TriangleBvhPtr> bvhsOf(std::vector<MeshPtr> meshes) {
  std::map<MeshPtr, TriangleBvhPtr> out;
  for (const MeshPtr& mesh : meshes) {
    if (!out.contains(mesh)) out.emplace(mesh, bvhOf(mesh));
  }
  return out;
}

}  // namespace

void GpuOccluders::storeMeshes(const std::map<MeshPtr, TriangleBvhPtr>& meshes, std::size_t top) {
  room_ = std::bit_ceil(top);
  Texels texels(room_);
  meshes_.clear();
  for (const auto& [mesh, bvh] : meshes) {
    Place& place = meshes_[mesh];
    place.nodes = std::uint32_t(texels.size());
    append(bvh->nodes, texels);
    place.triangles = std::uint32_t(texels.size());
    place.reach = float(glm::compMax(glm::max(glm::abs(mesh->bounds.min), glm::abs(mesh->bounds.max))));
    append(bvh->triangles, texels);
  }
  view_ = {};
  texels_ = {};  // first the old memory, then the new
  texels_ = gpu::Buffer("occluders", gpu::bytesOf(std::span<const Texel>(texels)), gpu::BufferUse::kDynamic);
  view_ = gpu::BufferTexture("occluders", texels_, gpu::BufferTexel::kUvec4);
}

void GpuOccluders::storeTop(const Inputs& inputs) {
  const Bvh bvh = bvhOf(inputs.occluders, inputs.grid.gridFromWorldMatrix());
  Texels texels = {{std::uint32_t(1 + kTexelsOfNode * bvh.nodes.size()), 0, 0, 0}};
  append(bvh.nodes, texels);
  for (const std::uint32_t i : bvh.order) {
    const Occluder& o = inputs.occluders[i];
    const glm::dmat4 objectFromGrid =
        glm::inverse(inputs.grid.gridFromWorldMatrix() * o.worldFromObject);
    const glm::mat4 rows(glm::transpose(objectFromGrid));
    for (int row = 0; row < 3; ++row) texels.push_back(std::bit_cast<Texel>(rows[row]));
    const Place& place = meshes_.at(o.mesh);
    texels.emplace_back(place.nodes, place.triangles, std::bit_cast<std::uint32_t>(place.reach), std::uint32_t(o.blocks));
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
    storeMeshes(trees.get(), texelsOfTop(inputs.occluders.size()));
  }
  storeTop(inputs);
  Inputs all = inputs;
  std::erase_if(all.occluders, [](const Occluder& o) { return o.blocks != kAllLights; });
  if (!surfaces_.holds(all)) surfaces_.set(std::move(all));
  made_.set(std::move(inputs));
}

void GpuOccluders::bind() const { view_.bind(layout::kOccluders); }

}  // namespace lpv
