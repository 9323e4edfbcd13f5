#pragma once
// Stage: voxelized lights into the field of emitted intensity (paper eq. 1; MATHS.md 2).

#include <vector>

#include "gpu/program.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/palette.h"

namespace lpv {

class Injector {
 public:
  Injector();

  /// Takes everything that `voxels` put into the field out of it: before any of them is made anew.
  GpuTask retire(LightField& field, const std::vector<LightVoxelsPtr>& voxels, Pacing pacing);
  /// Puts the lights in, in order. `voxels` and `palette.weights` are per light.
  GpuTask add(LightField& field, const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
              const Palette& palette, Pacing pacing);
  /// The same for lights that are trees of VPLs, into a field that held something else.
  GpuTask show(LightField& field, const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
               const Palette& palette, Pacing pacing);

 private:
  using Passes = std::vector<const char*>;  ///< of shaders/transport/inject.comp
  void dispatch(LightField& field, const LightVoxels& voxels, const Passes& passes);

  gpu::ProgramVariants programs_{{"transport/inject.comp"}};
  gpu::ProgramVariants vplPrograms_{{"transport/inject_vpls.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
