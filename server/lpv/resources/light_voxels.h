#pragma once
// One light in the grid, apart from the others: made from its geometry and texture only, so that a change of colour, of
// brightness or of another light leaves it as it is.

#include <cstddef>
#include <memory>
#include <vector>

#include "gpu/buffer.h"
#include "lpv/cached.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/vpl_tree.h"
#include "scene/options.h"

namespace lpv {

/// How triangles become voxels. Part of what voxels are made from.
struct VoxelMethod {
  Injection injection = Injection::kCount;
  InjectionMethod method = InjectionMethod::kCompute;
  int denseSamples = 0;  ///< per triangle, kDense only
  bool vpls = false;  ///< FLUX: into VPLs and their tree (GATHER, DIRECT), not into one lobe per cell

  bool operator==(const VoxelMethod&) const = default;
};

/// What a light's voxels are made from.
struct VoxelizeInputs {
  MeshPtr mesh;
  TexturePtr texture;
  glm::dmat4 gridFromObject{1.0};  ///< of the grid that it is voxelized in: the field's, or with VPLs its own
  glm::ivec3 dims{0};  ///< of that grid
  VoxelMethod method;
  glm::dvec3 origin{0.0};  ///< where that grid begins, cells of the field
  double cell = 1.0;  ///< edge of its cells, cells of the field

  bool operator==(const VoxelizeInputs&) const = default;
  bool textured() const { return texture != nullptr; }
  bool directed() const { return !mesh->directions.empty(); }
  /// FLUX of what is the same all over a flat patch: however it was cut up. COUNT counts the mesh's own triangles.
  bool merges() const {
    return method.injection == Injection::kFlux && method.method != InjectionMethod::kDense && !textured() &&
           !directed() && !mesh->merged.empty();
  }
  const std::vector<glm::uvec3>& triangles() const { return merges() ? mesh->merged : mesh->triangles; }
};

struct LightVoxels {
  /// Room for every cell of `box`, or, with `vpls`, for a tree over it.
  LightVoxels(const CellBox& box, int momentsPerCell, bool vpls = false);

  VoxelizeInputs source;  ///< what they are to be made from
  Cached<VoxelizeInputs> made;  ///< what they were made from: `cells` and `moments`, or `tree`
  int momentsPerCell = 1;  ///< moments per cell: 1, or 3 with a texture (shaders/voxelize/accumulators.glsl)
  std::size_t capacity = 0;  ///< cells
  gpu::Buffer cells;  ///< header and (cell, lobes) entries (layout::kVoxelCells)
  gpu::Buffer moments;  ///< vec4 per cell and set
  std::unique_ptr<VplTree> tree;  ///< instead of them, with VoxelMethod::vpls
  double areaScale = 1.0;  ///< FLUX: area that a moment of 1 stands for, cell^2; COUNT: 1
  double radianceScale = 1.0;  ///< radiance factor that a colour of 1 stands for
  int group = 0;  ///< of the field that it was put into
  double roundingError = 0.0;  ///< bound for one coefficient, relative to the largest possible

  bool ready() const { return made.madeFrom(source); }
  /// Makes room for the voxels of a light in this box, whose memory it takes over; false when they do not fit.
  bool takes(const CellBox& box, int wantedMoments, bool vpls);
};
using LightVoxelsPtr = std::shared_ptr<LightVoxels>;

}  // namespace lpv
