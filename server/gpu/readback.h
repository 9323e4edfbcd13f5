#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <string>

#include "gpu/buffer.h"
#include "gpu/framebuffer.h"

namespace lpv::gpu {

/// Host-visible, persistently mapped memory into which the GPU copies results. The copy is only queued here: the
/// caller inserts a Fence, polls it, and reads bytes() after it has signalled. Move-only; empty after move.
class Readback {
 public:
  Readback() = default;
  /// Throws Failure (RESOURCE_EXHAUSTED) when there is no memory.
  Readback(const std::string& label, std::size_t bytes);
  Readback(Readback&& other) noexcept;
  Readback& operator=(Readback&& other) noexcept;
  ~Readback();

  std::size_t size() const { return size_; }  ///< bytes

  /// Queues a copy of `bytes` of `source` from `sourceOffset` to `offset`.
  void copyFrom(const Buffer& source, std::size_t sourceOffset, std::size_t offset, std::size_t bytes);
  /// Queues glReadPixels of `rows` rows of colour attachment 0 from `row` on, in the framebuffer's order, tightly
  /// packed. Call it only when the drawing is known to have finished: on llvmpipe the call waits for it (notes: 40 ms
  /// against 0.8 ms).
  void copyPixels(const Framebuffer& source, int row, int rows, std::uint32_t layout, std::uint32_t type,
                  std::size_t offset);

  std::span<const std::byte> bytes() const { return {data_, size_}; }

 private:
  std::uint32_t id_ = 0;
  std::size_t size_ = 0;
  const std::byte* data_ = nullptr;
  Charge charge_;
};

}  // namespace lpv::gpu
