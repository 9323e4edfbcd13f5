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
  const Chunk whole = {0, buffer.size() / 4 * 4};
  co_await fillChunked(buffer, word, whole);
}

GpuTask fillChunked(gpu::Buffer& buffer, std::uint32_t word, Chunk part) {
  for (const Chunk& piece : chunksOf(part.bytes)) {
    buffer.fill(word, part.offset + piece.offset, piece.bytes);
    co_yield yield();
  }
}

}  // namespace lpv
