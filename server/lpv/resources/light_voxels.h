#pragma once
// One light in the grid, apart from the others: made from its geometry and texture only, so that a change of colour, of
// brightness or of another light leaves it as it is.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/resources/lights.h"
#include "scene/options.h"
#include "shaders/layout.h"

namespace lpv {

/// How triangles become voxels. Part of what voxels are made from.
struct VoxelMethod {
  Injection injection = Injection::kCount;
  InjectionMethod method = InjectionMethod::kCompute;
  int denseSamples = 0;  ///< per triangle, kDense only
  bool vpls = false;  ///< FLUX: into VPLs and their tree (GATHER, DIRECT), not into one lobe per cell

  bool operator==(const VoxelMethod&) const = default;
};

/// What a light's voxels follow from.
struct VoxelSource {
  MeshPtr mesh;
  TexturePtr texture;
  glm::dmat4 gridFromObject{1.0};
  glm::ivec3 dims{0};
  VoxelMethod method;

  bool operator==(const VoxelSource&) const = default;
  bool textured() const { return texture != nullptr; }
  bool directed() const { return !mesh->directions.empty(); }
};

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

struct LightVoxels {
  /// Room for every cell of `box`, or, with `vpls`, for a tree over it.
  LightVoxels(const CellBox& box, int momentsPerCell, bool vpls = false);

  VoxelSource source;
  bool made = false;  ///< `cells` and `moments` are what follows from `source`
  int momentsPerCell = 1;  ///< moments per cell: 1, or 3 with a texture (shaders/voxelize/deposit.glsl)
  std::size_t capacity = 0;  ///< cells
  gpu::Buffer cells;  ///< header and (cell, lobes) entries (layout::kVoxelCells)
  gpu::Buffer moments;  ///< vec4 per cell and set
  std::unique_ptr<VplTree> tree;  ///< instead of them, with VoxelMethod::vpls
  double areaScale = 1.0;  ///< FLUX: area that a moment of 1 stands for, cell^2; COUNT: 1
  double radianceScale = 1.0;  ///< radiance factor that a colour of 1 stands for
  int group = 0;  ///< of the field that it was put into
  double roundingError = 0.0;  ///< bound for one coefficient, relative to the largest possible

  /// Whether the voxels of a light in this box fit; a tree takes the box over.
  bool takes(const CellBox& box, int wantedMoments, bool vpls);
};
using LightVoxelsPtr = std::shared_ptr<LightVoxels>;

}  // namespace lpv
