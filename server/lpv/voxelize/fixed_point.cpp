#include "lpv/voxelize/fixed_point.h"

#include <cmath>
#include <string>

namespace lpv {

Expected<FixedPoint> fixedPointFor(std::uint64_t lobes) {
  constexpr std::uint64_t kLimit = 2147483647;
  constexpr int kFinest = 24;   // as fine as float: more would only hold noise
  constexpr int kCoarsest = 4;  // a cell's mean over so many lobes still has the digits that are missing here
  for (int shift = kFinest; shift >= kCoarsest; --shift) {
    const std::uint64_t largestWord = (std::uint64_t(1) << shift) + 1;  // a unit vector may be rounded up
    if (lobes <= kLimit / largestWord) return FixedPoint{shift, std::ldexp(0.5, -shift)};
  }
  return exhausted("lights", "a light puts up to " + std::to_string(lobes) +
                                 " lobes into one cell, more than its accumulators hold; use a coarser mesh, fewer "
                                 "dense samples, or injection FLUX");
}

}  // namespace lpv
