#pragma once
// Stage: transport GATHER (MATHS.md 3b.3-4): every cell that is asked for sums the lights' VPLs, nearby ones one by
// one, far ones as nodes of their tree.

#include <vector>

#include "gpu/program.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/palette.h"
#include "lpv/transport/cell_visibility.h"
#include "lpv/transport/light_sums.h"
#include "lpv/transport/receiver_blocks.h"
#include "lpv/transport/sectors.h"

namespace lpv {

/// What the gathered field is made from; the product is the blocks where it is made.
struct GatherInputs {
  Stamp memory = 0;           ///< of the field
  Stamp lights = 0;           ///< and with them their trees and the palette
  double openingRatio = 0.0;  ///< k
  int turns = 0;  ///< of shadow rays; 0: nothing stands in the way
  Stamp blockers = 0;  ///< what does

  bool operator==(const GatherInputs&) const = default;
};

/// Work of the stage, in entries visited: a walk sees most of a small tree, and of a large one what is near and a few
/// nodes of each size. A piece counts: the whole blocks that are asked for, light by light, lights without VPLs left
/// out. Admission: the cells' share of blocks, all lights, trees as large as surfaces in the grid are expected to make
/// them.
struct GatherWork {
  double blocks = 0.0;
  double lights = 0.0;
  double rootsOfEntries = 0.0;  ///< square roots of the sizes of the lights' trees, summed
  bool byDirection = false;     ///< layers by direction: eight sums in the place of one

  double units() const { return (byDirection ? kSectorWork : 1.0) * blocks * (16.0 * lights + 8.0 * rootsOfEntries); }
  static constexpr double kSectorWork = 2.0;  ///< seen on 32^3 cells
};

/// Lights as cells gather them.
struct GatheredLights {
  const std::vector<EmittingLight>& lights;
  const std::vector<LightVoxelsPtr>& voxels;
  const Palette& palette;
  double k = 0.0;  ///< the distance rule; infinite takes every VPL by itself
  Sectors sectors = Sectors::kNone;
  const CellShadows* shadows = nullptr;  ///< null where nothing stands in the way
};

class Gatherer {
 public:
  Gatherer();

  /// Takes all light out of the field.
  GpuTask clear(LightField& field);
  /// Adds what the lights send to these blocks, which hold zeros, as SH of incident radiance to field.transported().
  /// Each light goes into the layer of its group, or, with `sectors`, what comes from each into that sector's; what
  /// receivers look at of it into those apart. `sums`: what is kept of some, between begin() and end(), or empty.
  GpuTask run(LightField& field, const GatheredLights& lights, const ReceiverBlocks& blocks, LightSums& sums,
              Pacing pacing);

 private:
  struct Source;
  struct Targets;
  struct Into;
  struct Run;
  static Targets targetsOf(const EmittingLight& light, const LightField& field);
  GpuTask sum(Run& run, LightRange range, Into to, bool keep);
  GpuTask half(Run& run, LightRange range, Into to, bool keep);
  GpuTask addLight(Run& run, std::size_t light, Into to);
  GpuTask addSource(Run& run, const Source& source, const Targets& targets, Into to);
  GpuTask addSum(Run& run, const LightSum& sum, std::uint32_t layers, Into to);

  struct Variant {
    int channels = 1;
    bool textured = false;
    bool twoSided = false;
    Sectors sectors = Sectors::kNone;
    bool shadowed = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  CellVisibilityPass visibility_;
  gpu::Programs<Variant> programs_{{"transport/gather.comp"}};
  gpu::ProgramVariants sumProgram_{{"transport/gather_sum.comp"}};
  gpu::Buffer params_, sumParams_;
};

}  // namespace lpv
