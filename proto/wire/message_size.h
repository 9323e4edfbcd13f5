#pragma once
// How large messages may be, for server and clients alike.

#include <cstddef>

namespace lpv {

/// No message exceeds this in either direction, bytes.
inline constexpr std::size_t kMaxMessageBytes = 1024 * 1024;
/// Bulk bytes in one message: leaves room for the message around them.
inline constexpr std::size_t kMaxPartBytes = kMaxMessageBytes - 16 * 1024;

}  // namespace lpv
