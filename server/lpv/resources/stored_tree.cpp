#include "lpv/resources/stored_tree.h"

#include "lpv/pacing/chunked.h"

namespace lpv {

namespace {

static_assert(4 * sizeof(glm::vec2) == layout::kUvTexels * sizeof(OccluderTexel));

std::vector<glm::vec2> uvsOf(const Mesh& mesh, const TriangleBvh& bvh) {
  std::vector<glm::vec2> out;
  out.reserve(4 * bvh.indices.size());
  for (const std::uint32_t i : bvh.indices) {
    const glm::uvec3& t = mesh.triangles[i];
    out.insert(out.end(), {mesh.uvs[t.x], mesh.uvs[t.y], mesh.uvs[t.z], glm::vec2(0.0F)});
  }
  return out;
}

}  // namespace

std::size_t texelsOf(const TriangleBvh& tree, bool withUvs) {
  const std::size_t ofTriangle = layout::kTriangleTexels + (withUvs ? layout::kUvTexels : 0);
  return kTexelsOfNode * tree.nodes.size() + ofTriangle * tree.triangles.size();
}

GpuTask send(gpu::Buffer& buffer, std::size_t texel, std::span<const std::byte> bytes) {
  for (const Chunk& part : chunksOf(bytes.size())) {
    buffer.update(texel * sizeof(OccluderTexel) + part.offset, bytes.subspan(part.offset, part.bytes));
    co_yield yield();
  }
}

GpuTask storeTree(gpu::Buffer& buffer, std::span<const BvhNode> nodes, std::span<const BvhTriangle> triangles,
                  std::size_t& at, StoredTree& tree) {
  tree.nodes = std::uint32_t(at);
  tree.triangles = std::uint32_t(at + kTexelsOfNode * nodes.size());
  co_await send(buffer, tree.nodes, gpu::bytesOf(nodes));
  co_await send(buffer, tree.triangles, gpu::bytesOf(triangles));
  at = tree.triangles + layout::kTriangleTexels * triangles.size();
}

GpuTask storeUvs(gpu::Buffer& buffer, const Mesh& mesh, const TriangleBvh& bvh, std::size_t& at, StoredTree& tree) {
  const std::vector<glm::vec2> uvs = uvsOf(mesh, bvh);
  tree.uvs = std::uint32_t(at);
  co_await send(buffer, at, gpu::bytesOf(std::span<const glm::vec2>(uvs)));
  at += layout::kUvTexels * bvh.triangles.size();
}

}  // namespace lpv
