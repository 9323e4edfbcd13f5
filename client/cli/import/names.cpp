#include "import/names.h"

#include <algorithm>
#include <cstddef>
#include <optional>

#include "base/text.h"

namespace lpv::cli {
namespace {

constexpr std::size_t kLongest = 200;

/// With '_' in the place of what names must not have.
std::string cleaned(const std::string& text) {
  std::string out;
  std::size_t at = 0;
  while (const std::optional<HiddenCharacter> hidden = findHiddenCharacter(text, at)) {
    out += text.substr(at, hidden->at - at) + "_";
    at = hidden->at + hidden->bytes;
  }
  out += text.substr(at);
  std::replace(out.begin(), out.end(), '/', '_');
  return truncatedUtf8(out, kLongest);
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
