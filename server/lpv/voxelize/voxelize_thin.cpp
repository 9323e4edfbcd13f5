#include "lpv/voxelize/voxelize.h"

namespace lpv {

ThinVoxelizer::ThinVoxelizer()
    : list_("thin triangles",
            sizeof(layout::ListHeader) + std::size_t(layout::kMaxThinTriangles) * sizeof(std::uint32_t),
            gpu::BufferUse::kDynamic) {}

void ThinVoxelizer::begin() {
  list_.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
  list_.bindStorage(layout::kThinTriangles);
}

void ThinVoxelizer::dispatch(const VoxelizeJob& job) {
  list_.bindAsDispatchArguments();
  programs_.get(job.variant).dispatchIndirect(0);
  gpu::memoryBarrier();
}

}  // namespace lpv
