#include "lpv/resources/vpl_tree.h"

#include <bit>

namespace lpv {

namespace {

/// Nodes before each level of the tree over a box, and of all; how many levels that is.
int layOut(const CellBox& box, std::array<std::uint32_t, layout::kMaxLevels + 1>& offsets) {
  int level = 0;
  for (glm::ivec3 n(2); n != glm::ivec3(1); ++level) {
    n = box.empty() ? glm::ivec3(1) : ((box.upper - 1) >> level) - (box.lower >> level) + 1;
    offsets[std::size_t(level) + 1] = offsets[std::size_t(level)] + std::uint32_t(n.x * n.y * n.z);
  }
  return level;
}

}  // namespace

VplTree::VplTree(const CellBox& b) : box(b), levels(layOut(box, offsets)) {
  nodes = gpu::Buffer("tree nodes", std::bit_ceil(offsets[std::size_t(levels)]) * sizeof(glm::uvec4));
}

bool VplTree::adopt(const CellBox& other) {
  std::array<std::uint32_t, layout::kMaxLevels + 1> wanted{};
  const int count = layOut(other, wanted);
  if (wanted[std::size_t(count)] * sizeof(glm::uvec4) > nodes.size()) return false;
  box = other;
  levels = count;
  offsets = wanted;
  return true;
}

}  // namespace lpv
