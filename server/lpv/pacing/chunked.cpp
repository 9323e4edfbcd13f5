#include "lpv/pacing/chunked.h"

#include <algorithm>

namespace lpv {

std::vector<Part> partsOf(std::size_t bytes) {
  std::vector<Part> parts;
  for (std::size_t offset = 0; offset < bytes; offset += kBulkBytes)
    parts.push_back({offset, std::min(kBulkBytes, bytes - offset)});
  return parts;
}

Pieces fillInPieces(gpu::Buffer& buffer, std::uint32_t word) {
  for (const Part& part : partsOf(buffer.size() / 4 * 4)) {
    buffer.fill(word, part.offset, part.bytes);
    co_yield rest();
  }
}

}  // namespace lpv
