#pragma once
// Stage: light between the surfaces (MATHS.md 6, invariant 13): every patch gathers from those that it sees, with its
// own normal, bounce by bounce, and the last bounce leaves what patches send to receivers.

#include "gpu/program.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/occluders.h"
#include "lpv/resources/patch_set.h"

namespace lpv {

/// What two patches exchange, in pairs (Stage::kVisibility: a ray each, if all send one), and light between them, in
/// pairs and bounces (Stage::kReflect).
struct BounceWork {
  double patches = 0.0;
  double pairs() const { return 0.5 * patches * patches; }
};

class BouncePass {
 public:
  BouncePass();
  /// What every two patches exchange, by their shapes and by what stands between them.
  GpuTask findExchange(PatchSet& set, const GpuOccluders& occluders, Pacing pacing);
  /// Which of them have a light in between.
  GpuTask findLights(PatchSet& set, const GpuOccluders& occluders, Pacing pacing);
  /// From what came to the patches from the lights to what they send after `turns` - 1 turns of the plan among them;
  /// receivers see the last one themselves. `turns` is at least 1; `done`: how many the last run had, which this one
  /// goes on from; 0: pieces send what their patches do.
  GpuTask run(PatchSet& set, const BouncePlan& plan, int done, int turns, Pacing pacing);
  /// Before it: what comes from the lights to patches whose folds have pieces, by these.
  GpuTask takeMeans(PatchSet& set, Pacing pacing);
  /// After it, once pieces have been looked from, by so many turns of rays: what they send, and the patches that stand
  /// for them. `again`: how often they get from each other what they send by then; 0: what their patches sent, once.
  GpuTask finishPieces(PatchSet& set, int foldTurns, int again, Pacing pacing);
  /// After all, for receivers: how what patches send changes across them.
  GpuTask findSlopes(PatchSet& set, const GpuOccluders& occluders, Pacing pacing);

 private:
  struct Step {
    gpu::Program& program;
    Stage stage;
    int threads;
    double units;  ///< of the stage, per thread
  };
  struct StepVariant {
    int step;  ///< of shaders/transport/patch_balance.comp or patch_pieces.comp
    bool operator==(const StepVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_STEP", step)}; }
  };
  struct PaneVariant {
    bool transparent;
    bool operator==(const PaneVariant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_TRANSPARENT", transparent)}; }
  };
  struct CreviceVariant {
    int step;  ///< of shaders/transport/patch_crevices.comp
    bool transparent;
    bool operator==(const CreviceVariant&) const = default;
    gpu::Defines defines() const {
      return {gpu::define("LPV_STEP", step), gpu::define("LPV_TRANSPARENT", transparent)};
    }
  };
  /// One thread after the other, as many at a time as a piece of work may have.
  GpuTask dispatch(const Step& step, PatchSet& set, layout::PatchParams params, const GpuOccluders* occluders,
                   Pacing pacing);

  gpu::Programs<PaneVariant> exchange_{{"transport/patch_exchange.comp"}};
  gpu::Programs<CreviceVariant> crevices_{{"transport/patch_crevices.comp"}};
  gpu::ProgramVariants lights_{{"transport/patch_lights.comp"}};
  gpu::Programs<PaneVariant> bounce_{{"transport/patch_bounce.comp"}};
  gpu::Programs<PaneVariant> slopes_{{"transport/patch_slopes.comp"}};
  gpu::Programs<StepVariant> pieces_{{"transport/patch_pieces.comp"}};
  gpu::Programs<StepVariant> balance_{{"transport/patch_balance.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
