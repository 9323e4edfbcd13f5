#pragma once
// Stage: one light's VPLs, merged in the table where its triangles were voxelized, into a tree of blocks of cells
// (MATHS.md 3b.1-2).

#include <cstdint>
#include <functional>

#include "gpu/program.h"
#include "gpu/readback.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/resources/vpl_tree.h"

namespace lpv {

/// What the GPU says of a light's VPLs before they are put in order.
struct VplCounts {
  std::uint32_t vpls = 0;
  std::uint32_t degenerate = 0;  ///< triangles without area
  std::uint32_t lost = 0;        ///< VPLs that found no room in the table
  std::uint32_t entries = 0;     ///< of the whole tree
  std::uint32_t cells = 0;
};

/// What the numbers of the table stand for.
struct TreeScales {
  double areaScale = 1.0;  ///< area of a moment of 1, in cells of the light's grid, squared
  double moment = 1.0;     ///< fixed-point units of a moment of 1
  glm::dvec3 origin{0.0};  ///< where the light's grid begins, cells of the field
  double cell = 1.0;       ///< edge of its cells, cells of the field
};

/// `bindLight` binds the light's table and list, kAccumulators and kVoxelCells: anew in every piece, for others work in
/// between.
class VplTreeBuilder {
 public:
  VplTreeBuilder();

  /// Before voxelization: no leaf holds light.
  GpuTask prepare(VplTree& tree);
  /// After it: counts what there is, bottom up, into the list's header.
  GpuTask count(VplTree& tree, const gpu::Defines& variant, const std::function<void()>& bindLight);
  static VplCounts read(const gpu::Readback& header);
  /// Puts the counted VPLs into the tree's entries, which are made larger where needed. Throws gpu::Failure
  /// (RESOURCE_EXHAUSTED).
  GpuTask build(VplTree& tree, const VplCounts& counts, const gpu::Defines& variant, const TreeScales& scales,
                const std::function<void()>& bindLight);

 private:
  struct TreePass {
    gpu::ProgramVariants& program;
    int level;
    std::uint32_t threads;
  };
  GpuTask pass(const VplTree& tree, const gpu::Defines& variant, TreePass pass, const TreeScales& scales,
               const std::function<void()>& bindLight);

  gpu::Buffer params_;
  gpu::ProgramVariants count_{{"voxelize/vpl_count.comp"}};
  gpu::ProgramVariants number_{{"voxelize/vpl_number.comp"}};
  gpu::ProgramVariants leaves_{{"voxelize/vpl_leaves.comp"}};
  gpu::ProgramVariants merge_{{"voxelize/vpl_merge.comp"}};
};

}  // namespace lpv
