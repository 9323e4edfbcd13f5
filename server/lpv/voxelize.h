#pragma once
// Stage: light triangles into the grid (paper 3.1; MATHS.md 2, COUNT).

#include "gpu/program.h"
#include "lpv/clock.h"
#include "lpv/field.h"
#include "lpv/lights.h"
#include "lpv/scene_cache.h"

namespace lpv {

class Voxelizer {
 public:
  Voxelizer();

  /// A fresh list of touched cells and zeroed counters; the last tick's list becomes the other one.
  void begin(LightField& field);
  /// Adds the VPLs of one light to the accumulators, a bounded number of triangles at a time.
  Pieces add(LightField& field, const EmittingLight& light, const GpuMesh& mesh, const glm::dvec3& weight,
             const FixedPoint& fixedPoint, Pacing pacing);

 private:
  void dispatch(LightField& field, const GpuMesh& mesh, std::uint32_t triangles, bool twoSided);

  gpu::ProgramVariants programs_{{"voxelize.comp"}};
  gpu::Buffer params_;
  gpu::Buffer large_;  ///< work items of the piece under way
};

}  // namespace lpv
