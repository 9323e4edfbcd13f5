#define XXH_INLINE_ALL
#include <xxhash.h>

#include "wire/volume_state.h"

namespace lpv::wire {

std::uint64_t checksumBytes(const void* data, std::size_t size) { return XXH64(data, size, 0); }

}  // namespace lpv::wire
