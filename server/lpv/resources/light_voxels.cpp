#include "lpv/resources/light_voxels.h"

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

LightVoxels::LightVoxels(const CellBox& box, int moments_, bool vpls) : momentsPerCell(moments_) {
  if (vpls) {
    tree = std::make_unique<VplTree>(box);
    return;
  }
  capacity = roomFor(box);
  cells =
      gpu::Buffer("voxel cells", sizeof(layout::VoxelHeader) + capacity * sizeof(glm::uvec2), gpu::BufferUse::kDynamic);
  moments = gpu::Buffer("voxel moments", capacity * std::size_t(momentsPerCell) * sizeof(glm::vec4));
}

bool LightVoxels::takes(const CellBox& box, int wantedMoments, bool vpls) {
  if (wantedMoments != momentsPerCell || vpls != (tree != nullptr)) return false;
  if (vpls ? !tree->adopt(box) : cellsIn(box) > capacity) return false;
  made.forget();
  return true;
}

}  // namespace lpv
