#pragma once
// Stage: one light's triangles into its voxels (paper 3; MATHS.md 2). Three injectors make the same accumulator words
// out of the same pairs, or, the third, out of samples.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "gpu/framebuffer.h"
#include "gpu/program.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_texture.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/scene_cache.h"
#include "lpv/voxelize/vpl_tree_builder.h"
#include "shaders/layout.h"

namespace lpv {

/// What an injector is given: everything is bound but its own parameters.
struct VoxelizeJob {
  gpu::Defines variant;
  layout::VoxelizeParams params{};
  bool varying = false;  ///< with texture or directions
};

/// Adds triangles to the accumulators.
class TriangleVoxelizer {
 public:
  virtual ~TriangleVoxelizer() = default;
  /// The most triangles one call can take.
  virtual std::uint32_t limit(const VoxelizeJob& job) const = 0;
  /// params.triangleCount triangles from params.firstTriangle on.
  virtual void dispatch(const VoxelizeJob& job) = 0;
};

/// Triangles that snapping makes a segment over several cells, which have no columns: the injectors list them, and they
/// are voxelized after the others.
class ThinVoxelizer {
 public:
  ThinVoxelizer();
  /// An empty list, bound.
  void begin();
  /// What is in it.
  void dispatch(const VoxelizeJob& job);

 private:
  gpu::ProgramVariants programs_{{"voxelize/thin.comp"}};
  gpu::Buffer list_;
};

/// A thread per small triangle, work items of columns for large ones.
class ComputeVoxelizer final : public TriangleVoxelizer {
 public:
  ComputeVoxelizer();
  std::uint32_t limit(const VoxelizeJob& job) const override;
  void dispatch(const VoxelizeJob& job) override;

 private:
  gpu::ProgramVariants programs_{{"voxelize/voxelize.comp"}};
  gpu::Buffer large_;  ///< work items of the piece under way
  ThinVoxelizer thin_;
};

/// The paper's pipeline: the rasterizer walks the columns of every triangle along its dominant axis.
class RasterVoxelizer final : public TriangleVoxelizer {
 public:
  RasterVoxelizer();
  RasterVoxelizer(const RasterVoxelizer&) = delete;
  RasterVoxelizer& operator=(const RasterVoxelizer&) = delete;
  ~RasterVoxelizer() override;
  std::uint32_t limit(const VoxelizeJob& job) const override;
  void dispatch(const VoxelizeJob& job) override;

 private:
  gpu::ProgramVariants programs_{{"voxelize/voxelize.vert", "voxelize/voxelize.geom", "voxelize/voxelize.frag"}};
  ThinVoxelizer thin_;
  gpu::Framebuffer target_;  ///< no attachments; as large as the grid
  std::uint32_t noVertices_ = 0;  ///< a vertex array without attributes
};

/// Random points on every triangle (paper 4.1), for comparison.
class DenseVoxelizer final : public TriangleVoxelizer {
 public:
  std::uint32_t limit(const VoxelizeJob& job) const override;
  void dispatch(const VoxelizeJob& job) override;

 private:
  gpu::ProgramVariants programs_{{"voxelize/dense.comp"}};
};

/// Work of the stage. A piece counts: columns by each triangle's area. Admission: by a mesh's area in its light's pose.
struct VoxelizeWork {
  double triangles = 0.0;
  double columns = 0.0;  ///< of cells that the triangles meet, summed over triangles

  double units() const { return triangles + 0.5 * columns; }
};

class Voxelizer {
 public:
  Voxelizer();

  /// Fills `voxels`, whose source says from what, a bounded number of triangles at a time. `texture` is null for a
  /// light without. Throws gpu::Failure (RESOURCE_EXHAUSTED) for a mesh that the accumulators cannot hold.
  GpuTask run(LightField& field, const GpuMesh& mesh, const GpuLightTexture* texture, LightVoxels& voxels,
              Pacing pacing);

 private:
  struct Run;
  TriangleVoxelizer& voxelizerFor(InjectionMethod method);
  GpuTask voxelize(Run& run);
  GpuTask deposit(Run& run);
  GpuTask buildVplTree(Run& run);
  void bind(const Run& run);
  void collect(const Run& run);

  gpu::Buffer params_;
  ComputeVoxelizer compute_;
  RasterVoxelizer raster_;
  DenseVoxelizer dense_;
  gpu::ProgramVariants collect_{{"voxelize/collect.comp"}};
  VplTreeBuilder trees_;
};

}  // namespace lpv
