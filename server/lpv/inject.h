#pragma once
// Stage: accumulators into the field of emitted intensity (paper eq. 1; MATHS.md 2, COUNT).

#include "gpu/program.h"
#include "lpv/field.h"
#include "lpv/pieces.h"

namespace lpv {

class Injector {
 public:
  Injector();

  /// Over the touched cells of this tick and the last only; leaves the accumulators at zero.
  Pieces run(LightField& field, int shift);

 private:
  void dispatch(LightField& field, const gpu::Buffer& cells, bool retire);

  gpu::ProgramVariants programs_{{"inject.comp"}};
  gpu::Buffer params_;
};

}  // namespace lpv
