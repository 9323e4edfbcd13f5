#pragma once
// PAYLOAD_COMPRESSION_ZSTD: one zstd frame per message.

#include <cstddef>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::wire {

/// Compresses into one zstd frame whose header has the content's size.
std::string compress(std::string_view content);

/// Decompresses one zstd frame. INVALID_ARGUMENT if it is not one complete frame, its header lacks the content's size,
/// or that size exceeds `maxBytes`; memory is allocated only after these checks of the header.
Expected<std::string> decompress(std::string_view frame, std::size_t maxBytes);

}  // namespace lpv::wire
