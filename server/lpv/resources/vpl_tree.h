#pragma once

#include <array>
#include <cstdint>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/resources/cell_box.h"
#include "shaders/layout.h"

namespace lpv {

/// One light's VPLs and the tree over them (shaders/voxelize/vpl_tree.glsl, vpls.glsl; MATHS.md 3b.1-2).
struct VplTree {
  /// Nodes for every block of a box of cells.
  explicit VplTree(const CellBox& box);

  CellBox box;
  std::array<std::uint32_t, layout::kMaxLevels + 1> offsets{};  ///< nodes before each level, and of all
  int levels = 1;
  gpu::Buffer nodes;
  gpu::Buffer entries;  ///< nodes' headers and VPLs, depth first (shaders/transport/vpls.glsl)
  gpu::BufferTexture texels;  ///< the same, as transport reads them
  std::uint32_t entryCount = 0;
  std::uint32_t vplCount = 0;  ///< of the leaves
  std::uint32_t cellCount = 0;  ///< that hold light
  std::uint32_t degenerate = 0;  ///< triangles without area

  /// Takes another box over in the same memory; false when there is too little.
  bool adopt(const CellBox& other);
};

}  // namespace lpv
