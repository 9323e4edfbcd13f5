#pragma once
// What the calling thread has asked of GL so far, for tests of how much a scene costs.

#include <cstddef>
#include <cstdint>

namespace lpv::gpu {

struct Usage {
  std::uint64_t dispatches = 0;  ///< of compute programs; draws are not counted
  std::uint64_t objects = 0;     ///< buffers and textures that were made
  std::uint64_t bytes = 0;       ///< of buffers that were made
};

/// Rises only; what something takes is a difference.
Usage& usage();

}  // namespace lpv::gpu
