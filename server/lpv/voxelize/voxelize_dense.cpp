#include <algorithm>

#include "lpv/voxelize/voxelize.h"

namespace lpv {

namespace {

/// Samples of one call while pacing asks for more: bounded work, whatever one triangle gets.
constexpr std::uint32_t kMostSamples = 1u << 18;
constexpr std::uint32_t kMostGroups = 65535;

}  // namespace

std::uint32_t DenseVoxelizer::limit(const VoxelizeJob& job) const {
  return std::max(1u, kMostSamples / std::max(1u, job.params.samplesPerTriangle));
}

void DenseVoxelizer::dispatch(const VoxelizeJob& job) {
  const std::uint32_t threads = job.params.triangleCount * job.params.threadsPerTriangle;
  const std::uint32_t groups = (threads + std::uint32_t(layout::kVoxelizeGroup) - 1) / layout::kVoxelizeGroup;
  programs_.get(job.variant).dispatch(std::min(groups, kMostGroups), (groups + kMostGroups - 1) / kMostGroups);
  gpu::memoryBarrier();
}

}  // namespace lpv
