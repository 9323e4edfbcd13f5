#pragma once

#include <cstdint>

#include "base/status.h"

namespace lpv {

/// Fixed point of COUNT's accumulators (MATHS.md 2): value = word / 2^shift, values up to 1 per lobe.
struct FixedPoint {
  int shift = 0;
  double error = 0.0;  ///< bound of the rounding of one injected coefficient, relative to the largest possible
};
/// The finest for which `lobes` aligned lobes of one light in one cell cannot overflow int32. RESOURCE_EXHAUSTED when
/// there are too many for any.
Expected<FixedPoint> fixedPointFor(std::uint64_t lobes);

}  // namespace lpv
