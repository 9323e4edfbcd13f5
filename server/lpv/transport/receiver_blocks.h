#pragma once
// Where a volume is read, in blocks of cells: everywhere, or around surfaces.

#include <cstdint>
#include <vector>

#include "lpv/pacing/gpu_task.h"
#include "scene/scene.h"

namespace lpv {

/// Blocks of kBlockX x kBlockY x kBlockZ cells, packed as layout::kReceiverBlocks says, in ascending order.
using ReceiverBlocks = std::vector<std::uint32_t>;

/// All blocks of a grid.
ReceiverBlocks allBlocks(const glm::ivec3& dims);
/// What the blocks around surfaces follow from.
struct SurfaceBlocksInputs {
  Grid grid;
  std::vector<SurfacePtr> surfaces;

  bool operator==(const SurfaceBlocksInputs&) const = default;
};
SurfaceBlocksInputs surfaceBlocksInputs(const Scene& scene, const Grid& grid);

/// Those with a cell that a surface reads when it is lit: within one cell of one of its triangles. `inputs` outlives
/// the coroutine.
GpuTask blocksOfSurfaces(const SurfaceBlocksInputs& inputs, ReceiverBlocks& out);

}  // namespace lpv
