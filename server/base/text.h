#pragma once

#include <cstddef>
#include <string>

namespace lpv {

/// Bytes that messages repeat of a text that somebody sent and that no limit keeps short.
inline constexpr std::size_t kMostQuoted = 80;

/// The text's first bytes, at most `most`, cut before a UTF-8 character rather than within: half a character makes a
/// message that proto3 clients cannot read.
inline std::string truncatedUtf8(const std::string& text, std::size_t most = kMostQuoted) {
  if (text.size() <= most) return text;
  std::size_t end = most;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;
  return text.substr(0, end);
}

}  // namespace lpv
