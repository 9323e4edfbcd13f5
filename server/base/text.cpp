#include "base/text.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <iterator>
#include <utility>

namespace lpv {
namespace {

constexpr char32_t kNoUtf8 = 0xFFFD;
constexpr char32_t kJoiner = 0x200D;
constexpr char32_t kEmojiStyle = 0xFE0F;

using Range = std::pair<char32_t, char32_t>;

/// Unicode 15, in order: Cc, Zl, Zp, Bidi_Control, Default_Ignorable_Code_Point.
constexpr std::array<Range, 22> kHidden = {
    {{0x00, 0x1F},       {0x7F, 0x9F},       {0xAD, 0xAD},       {0x34F, 0x34F},     {0x61C, 0x61C},
     {0x115F, 0x1160},   {0x17B4, 0x17B5},   {0x180B, 0x180F},   {0x200B, 0x200F},   {0x2028, 0x202E},
     {0x2060, 0x206F},   {0x3164, 0x3164},   {0xD800, 0xDFFF},   {0xFE00, 0xFE0F},   {0xFEFF, 0xFEFF},
     {0xFFA0, 0xFFA0},   {0xFFF0, 0xFFFB},   {kNoUtf8, kNoUtf8}, {0x1BCA0, 0x1BCA3}, {0x1D173, 0x1D17A},
     {0xE0000, 0xE0FFF}, {0xFFFFE, 0x10FFFF}}};
/// Arrows, symbols and pictographs that emoji are made of.
constexpr std::array<Range, 3> kSymbols = {{{0x203C, 0x203C}, {0x2122, 0x3299}, {0x1F000, 0x1FAFF}}};

template <std::size_t count>
bool within(const std::array<Range, count>& ranges, char32_t code) {
  return std::any_of(ranges.begin(), ranges.end(),
                     [code](const Range& range) { return code >= range.first && code <= range.second; });
}

struct Character {
  char32_t code = kNoUtf8;
  std::size_t bytes = 1;
};

std::size_t lengthByLead(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead < 0xE0) return 2;
  if (lead >= 0xE0 && lead < 0xF0) return 3;
  return lead >= 0xF0 && lead < 0xF5 ? 4 : 0;
}

Character characterAt(std::string_view text, std::size_t at) {
  static constexpr std::array<char32_t, 5> kLeast = {0, 0, 0x80, 0x800, 0x10000};
  const auto lead = static_cast<unsigned char>(text[at]);
  const std::size_t bytes = lengthByLead(lead);
  if (bytes == 0 || at + bytes > text.size()) return {};
  char32_t code = bytes == 1 ? lead : lead & (0xFFU >> (bytes + 1));
  for (std::size_t i = 1; i < bytes; ++i) {
    const auto next = static_cast<unsigned char>(text[at + i]);
    if ((next & 0xC0U) != 0x80U) return {};
    code = code << 6U | (next & 0x3FU);
  }
  if (code < kLeast[bytes]) return {};
  return {code, bytes};
}

bool belongsTo(char32_t before, char32_t code) {
  if (code == kEmojiStyle) return within(kSymbols, before);
  return code == kJoiner && (before == kEmojiStyle || within(kSymbols, before));
}

std::string escaped(char32_t code) {
  std::array<char, 16> out{};
  if (code < 0x10000) {
    std::snprintf(out.data(), out.size(), "\\u%04x", unsigned(code));
  } else {
    const unsigned rest = unsigned(code) - 0x10000U;
    std::snprintf(out.data(), out.size(), "\\u%04x\\u%04x", 0xD800U + (rest >> 10U), 0xDC00U + (rest & 0x3FFU));
  }
  return out.data();
}

}  // namespace

std::string HiddenCharacter::name() const {
  std::array<char, 16> out{};
  std::snprintf(out.data(), out.size(), "U+%04X", unsigned(code));
  return out.data();
}

std::optional<HiddenCharacter> findHiddenCharacter(std::string_view text, std::size_t from) {
  char32_t before = 0;
  for (std::size_t at = from; at < text.size();) {
    const Character now = characterAt(text, at);
    if (within(kHidden, now.code) && !belongsTo(before, now.code)) return HiddenCharacter{at, now.bytes, now.code};
    before = now.code;
    at += now.bytes;
  }
  return std::nullopt;
}

std::string withHiddenEscaped(std::string_view text, std::string_view keep) {
  std::string out;
  std::size_t at = 0;
  while (const std::optional<HiddenCharacter> hidden = findHiddenCharacter(text, at)) {
    out += text.substr(at, hidden->at - at);
    const std::string_view character = text.substr(hidden->at, hidden->bytes);
    if (hidden->bytes == 1 && keep.find(character) != std::string_view::npos) {
      out += character;
    } else {
      out += escaped(hidden->code);
    }
    at = hidden->at + hidden->bytes;
  }
  return out += text.substr(at);
}

}  // namespace lpv
