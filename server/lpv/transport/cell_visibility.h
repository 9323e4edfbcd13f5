#pragma once
// Stage: what the cells of the volume see of each light (GATHER; MATHS.md 3d).

#include <cstddef>
#include <vector>

#include "gpu/program.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_pools.h"
#include "lpv/resources/lights.h"
#include "lpv/resources/occluders.h"
#include "shaders/layout.h"

namespace lpv {

/// What one light's visibility is made from.
struct CellVisibilityInputs {
  Emission light;   ///< its radiance and group left out
  int index = 0;    ///< of those that emit
  glm::ivec3 dims{0};
  int turns = 0;    ///< of four rays
  Stamp blockers = 0;

  bool operator==(const CellVisibilityInputs&) const = default;
};

/// Per light, a layout::CellVisibility per cell. A light that did not change keeps its own, while all of them do not
/// take much memory; else they have one after the other.
struct CellVisibilities {
  std::vector<Cached<CellVisibilityInputs, gpu::Buffer>> lights;
};

/// In rays, if all are sent.
struct CellVisibilityWork {
  double cells = 0.0;
  double lights = 0.0;
  double turns = 1.0;
  double units() const { return 4.0 * turns * cells * lights; }
};

/// Turns of four rays from a cell to each of so many lights, by settings alone.
int cellTurns(Quality quality, std::size_t lights);

/// What stands between cells and lights.
struct CellShadows {
  const LightPools* points = nullptr;
  const GpuOccluders* occluders = nullptr;
  int turns = 1;
  CellVisibilities* known = nullptr;
};

class CellVisibilityPass {
 public:
  CellVisibilityPass();
  /// Makes what is not known of one light; `out` is where it is, until the next call.
  GpuTask run(const LightField& field, const std::vector<EmittingLight>& lights, std::size_t light,
              const CellShadows& shadows, const gpu::Buffer*& out, Pacing pacing);

 private:
  GpuTask sendRays(layout::CellVisibilityParams params, const CellShadows& shadows, const gpu::Buffer& out,
                   Pacing pacing);

  struct Variant {
    bool transparent = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const { return {gpu::define("LPV_TRANSPARENT", transparent)}; }
  };
  gpu::Programs<Variant> program_{{"transport/cell_visibility.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
