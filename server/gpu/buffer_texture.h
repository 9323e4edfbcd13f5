#pragma once

#include <cstdint>
#include <string>

#include "gpu/buffer.h"

namespace lpv::gpu {

/// A view of a whole buffer as one row of vec4 texels (RGBA32F), to be read with texelFetch: on llvmpipe two to three
/// times faster than storage reads. The buffer outlives it. Move-only; empty (id 0) after move.
class BufferTexture {
 public:
  BufferTexture() = default;
  /// Throws Failure (RESOURCE_EXHAUSTED) when the buffer is larger than the device's texture buffers.
  BufferTexture(const std::string& label, const Buffer& buffer);
  BufferTexture(BufferTexture&& other) noexcept;
  BufferTexture& operator=(BufferTexture&& other) noexcept;
  ~BufferTexture();

  void bind(std::uint32_t unit) const;

 private:
  std::uint32_t id_ = 0;
};

}  // namespace lpv::gpu
