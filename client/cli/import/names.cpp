#include "import/names.h"

#include <cstddef>

namespace lpv::cli {
namespace {

constexpr std::size_t kLongest = 200;

/// Bytes of the UTF-8 character that begins at `at`; 0 if none does.
std::size_t characterBytes(const std::string& text, std::size_t at) {
  const auto lead = static_cast<unsigned char>(text[at]);
  const std::size_t bytes = lead < 0x80                   ? 1
                            : lead >= 0xc2 && lead < 0xe0 ? 2
                            : lead >= 0xe0 && lead < 0xf0 ? 3
                            : lead >= 0xf0 && lead < 0xf5 ? 4
                                                          : 0;
  if (bytes == 0 || at + bytes > text.size()) return 0;
  for (std::size_t i = 1; i < bytes; ++i) {
    if ((static_cast<unsigned char>(text[at + i]) & 0xc0U) != 0x80U) return 0;
  }
  return bytes;
}

std::string cleaned(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = characterBytes(text, at);
    const auto lead = static_cast<unsigned char>(text[at]);
    const bool printable = bytes > 0 && lead >= 0x20 && lead != 0x7f && lead != '/' &&
                           !(bytes == 2 && lead == 0xc2 && static_cast<unsigned char>(text[at + 1]) < 0xa0);
    if (out.size() + (printable ? bytes : 1) > kLongest) break;
    out += printable ? text.substr(at, bytes) : "_";
    at += bytes > 0 ? bytes : 1;
  }
  return out;
}

bool madeUp(const std::string& name) {
  return name.empty() || name.front() == '<' || name == "defaultobject" || name == "ROOT" || name == "nodes[0]";
}

}  // namespace

std::string objectName(const std::string& node, const std::string& mesh, const std::string& fileStem) {
  const std::string& best = !madeUp(node) ? node : !madeUp(mesh) ? mesh : fileStem;
  const std::string name = cleaned(best);
  return name.empty() ? "object" : name;
}

}  // namespace lpv::cli
