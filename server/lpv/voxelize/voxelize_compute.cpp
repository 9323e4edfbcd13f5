#include "lpv/voxelize/voxelize.h"

namespace lpv {

namespace {

std::uint32_t groups(std::uint32_t threads, int perGroup) {
  return (threads + std::uint32_t(perGroup) - 1) / std::uint32_t(perGroup);
}

gpu::Defines compiledFor(gpu::Defines variant, const char* name) {
  variant.emplace_back(name, "1");
  return variant;
}

}  // namespace

ComputeVoxelizer::ComputeVoxelizer()
    : large_("large triangles",
             sizeof(layout::ListHeader) +
                 std::size_t(layout::kMaxPieceTriangles * layout::kMaxSlices) * sizeof(std::uint32_t),
             gpu::BufferUse::kDynamic) {}

std::uint32_t ComputeVoxelizer::limit(const VoxelizeJob& job) const {
  if (!job.varying) return layout::kMaxPieceTriangles;
  return layout::kMaxPieceTriangles * layout::kMaxSlices / layout::kMaxVaryingSlices;
}

void ComputeVoxelizer::dispatch(const VoxelizeJob& job) {
  thin_.begin();
  large_.update(0, gpu::bytesOfValue(layout::kEmptyListHeader));
  large_.bindStorage(layout::kLargeTriangles);
  large_.bindAsDispatchArguments();
  programs_.get(compiledFor(job.variant, "LPV_SMALL"))
      .dispatch(groups(job.params.triangleCount, layout::kVoxelizeGroup));
  gpu::memoryBarrier();
  programs_.get(compiledFor(job.variant, "LPV_LARGE")).dispatchIndirect(0);
  gpu::memoryBarrier();
  thin_.dispatch(job);
}

}  // namespace lpv
