#pragma once

#include <cstdint>
#include <string>

namespace lpv::gpu {

/// Capabilities of the current context. Everything required is in 4.5 core; these are for the log, for the device's
/// limits, and for choosing how much work goes into one piece.
struct Capabilities {
  std::string renderer;  ///< GL_RENDERER
  std::string vendor;    ///< GL_VENDOR
  std::string version;   ///< GL_VERSION
  bool software = false;             ///< rasterises on the CPU (llvmpipe, softpipe, swr)
  bool exactFilter = false;          ///< texture filters weigh texels by floats; GPUs by 8 bits
  bool robust = false;               ///< the context is lost, not corrupted, on a reset
  bool fp64 = true;                  ///< double in shaders: core since 4.0, probed because pair tests stand on it
  std::int64_t maxStorageBytes = 0;  ///< largest shader storage block, bytes
  std::int64_t maxTextureBufferTexels = 0;
  int max3dTextureEdge = 0;          ///< texels
  int maxComputeGroups = 0;          ///< groups along x
  int uniformAlignment = 256;        ///< bytes between ranges of one uniform buffer
};

/// Reads the capabilities of the current context and logs one line.
Capabilities probeCapabilities();

}  // namespace lpv::gpu
