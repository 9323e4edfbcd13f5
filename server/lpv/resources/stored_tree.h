#pragma once
// Trees over triangles in the buffer that shadow rays read (shaders/visibility/occluders.glsl).

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "gpu/buffer.h"
#include "lpv/pacing/gpu_task.h"
#include "scene/triangle_bvh.h"
#include "shaders/layout.h"

namespace lpv {

using OccluderTexel = glm::uvec4;
inline constexpr std::size_t kTexelsOfNode = sizeof(BvhNode) / sizeof(OccluderTexel);
static_assert(sizeof(BvhNode) == 32 && sizeof(BvhTriangle) == layout::kTriangleTexels * sizeof(OccluderTexel));
static_assert(kLeafItems == layout::kLeafItems);

/// Where a tree is, in texels.
struct StoredTree {
  std::uint32_t nodes = 0;
  std::uint32_t triangles = 0;  ///< and one past the last node
  std::uint32_t uvs = 0;        ///< of the triangles; 0: none
};

/// Of as many nodes and triangles, and of the triangles' texture coordinates.
std::size_t texelsOf(const TriangleBvh& tree, bool withUvs);

/// Puts bytes at a texel, some megabytes at a time.
GpuTask send(gpu::Buffer& buffer, std::size_t texel, std::span<const std::byte> bytes);
/// Puts nodes and triangles at `at`, which is afterwards one past them.
GpuTask storeTree(gpu::Buffer& buffer, std::span<const BvhNode> nodes, std::span<const BvhTriangle> triangles,
                  std::size_t& at, StoredTree& tree);
/// The same of texture coordinates of a mesh's triangles in the order of its tree.
GpuTask storeUvs(gpu::Buffer& buffer, const Mesh& mesh, const TriangleBvh& bvh, std::size_t& at, StoredTree& tree);

}  // namespace lpv
