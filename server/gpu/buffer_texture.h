#pragma once

#include <cstdint>
#include <string>

#include "gpu/buffer.h"

namespace lpv::gpu {

/// Type of one texel of a buffer texture.
enum class BufferTexel {
  kVec4,   ///< 4 floats
  kVec3,   ///< 3 floats
  kUvec3,  ///< 3 unsigned integers
  kUvec4,  ///< 4 unsigned integers
};

/// A texture over a whole buffer, one row of texels read with texelFetch: on llvmpipe two to three times faster
/// than storage reads. The buffer must outlive it. Move-only; empty (id 0) after move.
class BufferTexture {
 public:
  BufferTexture() = default;
  /// Throws Failure (RESOURCE_EXHAUSTED) when the buffer is larger than the device's texture buffers.
  BufferTexture(const std::string& label, const Buffer& buffer, BufferTexel texel = BufferTexel::kVec4);
  BufferTexture(BufferTexture&& other) noexcept;
  BufferTexture& operator=(BufferTexture&& other) noexcept;
  ~BufferTexture();

  void bind(std::uint32_t unit) const;

 private:
  std::uint32_t id_ = 0;
};

}  // namespace lpv::gpu
