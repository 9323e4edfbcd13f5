#include "lpv/pacing/chunked.h"

#include <algorithm>

namespace lpv {

std::vector<Chunk> chunksOf(std::size_t bytes) {
  std::vector<Chunk> parts;
  for (std::size_t offset = 0; offset < bytes; offset += kChunkBytes)
    parts.push_back({offset, std::min(kChunkBytes, bytes - offset)});
  return parts;
}

GpuTask fillChunked(gpu::Buffer& buffer, std::uint32_t word) {
  for (const Chunk& part : chunksOf(buffer.size() / 4 * 4)) {
    buffer.fill(word, part.offset, part.bytes);
    co_yield yield();
  }
}

}  // namespace lpv
