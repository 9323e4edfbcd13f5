#pragma once
// Sizes of messages, which servers and clients have to agree on.

#include <cstddef>

namespace lpv::wire {

/// No message exceeds this in either direction.
inline constexpr std::size_t kMaxMessageBytes = std::size_t(1) << 20U;
/// Bulk bytes in one message: leaves room for its other fields.
inline constexpr std::size_t kMaxPartBytes = kMaxMessageBytes - 16 * 1024;

}  // namespace lpv::wire
