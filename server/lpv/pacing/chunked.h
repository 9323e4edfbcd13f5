#pragma once
// Much memory at once, a bounded part at a time: a grid of 128^3 with groups has gigabytes.

#include <cstddef>
#include <cstdint>
#include <vector>

#include "gpu/buffer.h"
#include "lpv/pacing/gpu_task.h"

namespace lpv {

/// Bytes that are cleared or copied in one piece: a few milliseconds without a GPU, also where memory is new.
inline constexpr std::size_t kChunkBytes = std::size_t(8) << 20;

/// One such part of something larger.
struct Chunk {
  std::size_t offset;
  std::size_t bytes;
};
std::vector<Chunk> chunksOf(std::size_t bytes);

/// Fills `buffer`, which outlives the coroutine, with one 32-bit word.
GpuTask fillChunked(gpu::Buffer& buffer, std::uint32_t word = 0);
/// A part of it.
GpuTask fillChunked(gpu::Buffer& buffer, std::uint32_t word, Chunk part);

}  // namespace lpv
