#include "lpv/voxels.h"

#include <algorithm>
#include <bit>

#include "shaders/layout.h"

namespace lpv {

namespace {

std::size_t cellsIn(const CellBox& box) {
  if (box.empty()) return 0;
  const glm::ivec3 n = box.upper - box.lower;
  return std::size_t(n.x) * std::size_t(n.y) * std::size_t(n.z);
}

/// With room for a light that moves on: it touches a few cells more or less every tick.
std::size_t roomFor(const CellBox& box) { return std::bit_ceil(std::max<std::size_t>(cellsIn(box), 64)); }

}  // namespace

LightVoxels::LightVoxels(const CellBox& box, int s)
    : sets(s),
      capacity(roomFor(box)),
      cells("voxel cells",
            std::size_t(layout::kVoxelHeaderWords) * sizeof(std::uint32_t) + capacity * sizeof(glm::uvec2),
            gpu::BufferUse::kDynamic),
      moments("voxel moments", capacity * std::size_t(s) * sizeof(glm::vec4)) {}

bool LightVoxels::fits(const CellBox& box, int wantedSets) const {
  return cellsIn(box) <= capacity && wantedSets == sets;
}

}  // namespace lpv
