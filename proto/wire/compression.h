#pragma once
// PAYLOAD_COMPRESSION_ZSTD: one zstd frame per message.

#include <cstddef>
#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::wire {

/// One zstd frame that says its content's size.
std::string compress(std::string_view content);

/// The content of a frame. INVALID_ARGUMENT where it is no whole frame, does not say its content's size, or says more
/// than `maxBytes`; nothing is allocated then.
Expected<std::string> decompress(std::string_view frame, std::size_t maxBytes);

}  // namespace lpv::wire
