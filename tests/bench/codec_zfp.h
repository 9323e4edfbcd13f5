#pragma once
// zfp (Lindstrom 2014), an outside reference for what a volume's floats can be packed into.

#include <cstddef>

#include "scene/volume.h"

namespace lpv::bench {

/// A volume after zfp: what it takes, and what is left of it.
struct ZfpVolume {
  std::size_t bytes = 0;
  double encodeMs = 0.0, decodeMs = 0.0;  ///< CPU times
  Volume decoded;
};

/// Each coefficient of each colour and layer as a field of its own, to `tolerance` of the layer's largest first
/// coefficient.
ZfpVolume throughZfp(const Volume& volume, double tolerance);

}  // namespace lpv::bench
