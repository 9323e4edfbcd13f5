#pragma once
// Stage: one light's VPLs, merged in the table where its triangles were voxelized, into a tree of blocks of cells
// (MATHS.md 3b.1-2).

#include <cstdint>

#include "gpu/program.h"
#include "gpu/readback.h"
#include "lpv/voxels.h"

namespace lpv {

/// What the GPU says of a light's VPLs before they are put in order.
struct VplCounts {
  std::uint32_t vpls = 0;
  std::uint32_t degenerate = 0;  ///< triangles without area
  std::uint32_t lost = 0;        ///< VPLs that found no room in the table
  std::uint32_t records = 0;     ///< of the whole tree
  std::uint32_t cells = 0;
};

/// Table and list, bound by the caller: kAccumulators, kVoxelCells.
class TreeBuilder {
 public:
  TreeBuilder();

  /// Before voxelization: no leaf holds light.
  void prepare(VplTree& tree);
  /// After it: counts what there is, bottom up, into the list's header.
  void count(VplTree& tree, const gpu::Defines& variant);
  static VplCounts read(const gpu::Readback& header);
  /// Puts the counted VPLs into the tree's records, which are made larger where needed. `unit`: area that a moment of 1
  /// stands for, cell^2; `scale`: fixed-point units of a moment of 1. Throws gpu::Failure (RESOURCE_EXHAUSTED).
  void build(VplTree& tree, const VplCounts& counts, const gpu::Defines& variant, double unit, double scale);

 private:
  void pass(const VplTree& tree, const gpu::Defines& variant, const char* name, int level, std::uint32_t threads);

  layout::TreeParams shape_{};
  gpu::Buffer params_;
  gpu::ProgramVariants programs_{{"tree.comp"}};
};

}  // namespace lpv
