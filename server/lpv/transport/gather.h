#pragma once
// Stage: transport GATHER (MATHS.md 3b.3-4): every cell that is asked for sums the lights' VPLs, nearby ones one by
// one, far ones as nodes of their tree.

#include <vector>

#include "gpu/program.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/transport/receiver_blocks.h"

namespace lpv {

class Gatherer {
 public:
  Gatherer();

  /// Adds what the lights send to these blocks, which hold zeros, as SH of incident radiance to field.transported().
  /// `k`: the distance rule; infinite takes every VPL by itself.
  GpuTask run(LightField& field, const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
              const Palette& palette, double k, const ReceiverBlocks& blocks, Pacing pacing);

 private:
  void bind(const LightField& field, const LightVoxels& voxels);

  gpu::ProgramVariants programs_{{"transport/gather.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
