#pragma once
// Stage: transport by propagation (Kaplanyan & Dachsbacher 2010; MATHS.md 3a).

#include "gpu/program.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/pacing/stage_clock.h"
#include "lpv/resources/cell_box.h"
#include "lpv/resources/light_field.h"

namespace lpv {

/// What the propagated field is made from.
struct PropagateInputs {
  Stamp injected = 0;  ///< and with it the box that holds every cell that emits
  int iterations = 0;
  bool clampFaces = false;

  bool operator==(const PropagateInputs&) const = default;
};

/// Work of the stage. A piece counts: layers of the box that light has reached by an iteration. Admission: all cells
/// each time.
struct PropagateWork {
  double cells = 0.0;  ///< summed over iterations
  double channels = 0.0;  ///< of all groups

  double units() const { return cells * channels; }
};

class Propagator {
 public:
  Propagator();

  /// The injected field and `iterations` steps of it, summed. `box` holds every cell that emits: step i is computed
  /// only as far as light has come, which loses nothing.
  GpuTask run(LightField& field, CellBox box, int iterations, bool clampFaces, Pacing pacing);

 private:
  void step(LightField& field, const CellBox& box, int iteration, bool clampFaces);

  struct Variant {
    int channels = 1;
    bool clampFaces = false;
    bool operator==(const Variant&) const = default;
    gpu::Defines defines() const;
  };
  gpu::Programs<Variant> programs_{{"transport/propagate.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
