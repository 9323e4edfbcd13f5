#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

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

/// The first character of a text that people do not see as it is: control characters, line separators, characters that
/// change the direction of what follows, invisible ones (Unicode's Cc, Zl, Zp, Bidi_Control and
/// Default_Ignorable_Code_Point), and bytes that are no UTF-8. Joiners and emoji selectors after a symbol are part of
/// it.
struct HiddenCharacter {
  std::size_t at = 0;     ///< byte in the text
  std::size_t bytes = 1;  ///< of the character
  char32_t code = 0;      ///< U+FFFD for bytes that are no UTF-8

  /// "U+202E".
  std::string name() const;
};
std::optional<HiddenCharacter> findHiddenCharacter(std::string_view text, std::size_t from = 0);

/// The text with hidden characters as JSON writes them, \u202e; those of `keep` stay. Bytes that are no UTF-8 become
/// \ufffd.
std::string withHiddenEscaped(std::string_view text, std::string_view keep = {});

}  // namespace lpv
