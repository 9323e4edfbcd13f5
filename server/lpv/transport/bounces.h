#pragma once
// Stage: light between the surfaces (MATHS.md 6, invariant 13): every patch gathers from those that it sees, with its
// own normal, bounce by bounce, and the last bounce leaves what patches send to receivers.

#include "gpu/program.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/occluders.h"
#include "lpv/resources/patch_set.h"

namespace lpv {

/// Which patches see each other, in pairs (Stage::kVisibility: a ray each, if all send one), and light between them, in
/// pairs and bounces (Stage::kReflect).
struct BounceWork {
  double patches = 0.0;
  double pairs() const { return 0.5 * patches * patches; }
};

class BouncePass {
 public:
  BouncePass();
  GpuTask findPairs(PatchSet& set, const GpuOccluders& occluders, Pacing pacing);
  /// From what came to the patches from the lights to what they send after `bounces` - 1 reflections among them;
  /// receivers see the last one themselves. `bounces` is at least 1.
  GpuTask run(PatchSet& set, int bounces, Pacing pacing);

 private:
  void bind(const PatchSet& set, const layout::PatchParams& params);

  struct BounceVariant {
    bool colours = false;  ///< of PatchSet
    gpu::Defines defines() const { return {gpu::define("LPV_PAIR_COLOURS", colours)}; }
  };
  struct PairVariant {
    bool colours = false;
    bool transparent = false;
    gpu::Defines defines() const {
      return {gpu::define("LPV_PAIR_COLOURS", colours), gpu::define("LPV_TRANSPARENT", transparent)};
    }
  };
  gpu::Programs<PairVariant> pairs_{{"transport/patch_visibility.comp"}};
  gpu::Programs<BounceVariant> bounce_{{"transport/patch_bounce.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
