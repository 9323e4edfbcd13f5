#pragma once
// Stage: voxelized lights into the field of emitted intensity (paper eq. 1; MATHS.md 2).

#include <vector>

#include "gpu/program.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/light_field.h"
#include "lpv/resources/light_voxels.h"
#include "lpv/resources/palette.h"

namespace lpv {

/// What the injected field is made from.
struct InjectInputs {
  Stamp memory = 0;  ///< of the field
  Stamp lights = 0;  ///< and with them their voxels and the palette

  bool operator==(const InjectInputs&) const = default;
};

/// Work of the stage. A piece counts: for each pass over a light (to take it out, to put it in, COUNT's division of
/// several lights) the cells that its voxels have room for, or the box of its tree. Admission: one pass over the cells
/// that its surface may pass through.
struct InjectWork {
  double lights = 0.0;
  double cells = 0.0;  ///< summed over lights

  double units() const { return 1000.0 * lights + cells; }
};

class Injector {
 public:
  Injector();

  /// Takes all light out of the field: cell by cell of field.injectedVoxels, so it comes before any of these is made
  /// anew, or where they are not known by clearing all of it.
  GpuTask retire(LightField& field, Pacing pacing);
  /// Puts the lights in, in order, and counts. `voxels` and `palette.weights` are per light.
  GpuTask add(LightField& field, const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
              const Palette& palette, Pacing pacing);
  /// The same for lights that are trees of VPLs, into a field that held something else.
  GpuTask show(LightField& field, const std::vector<EmittingLight>& lights, const std::vector<LightVoxelsPtr>& voxels,
               const Palette& palette, Pacing pacing);

 private:
  /// Of shaders/transport/inject.comp.
  struct Passes {
    bool operator==(const Passes&) const = default;
    bool retire = false;
    bool add = false;
    bool divide = false;
  };
  struct VplVariant {
    int channels = 1;
    bool textured = false;
    bool operator==(const VplVariant&) const = default;
    gpu::Defines defines() const;
  };
  struct Variant {
    VplVariant light;
    Passes passes;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  void dispatch(LightField& field, const LightVoxels& voxels, Passes passes);

  gpu::Programs<Variant> programs_{{"transport/inject.comp"}};
  gpu::Programs<VplVariant> vplPrograms_{{"transport/inject_vpls.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
