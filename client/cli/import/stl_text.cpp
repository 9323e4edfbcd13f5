#include "import/stl_text.h"

#include <algorithm>
#include <cctype>

#include "import/text_lines.h"

namespace lpv::cli {
namespace {

std::string lowerCase(std::string_view text) {
  std::string out(text);
  std::transform(out.begin(), out.end(), out.begin(), [](unsigned char c) { return std::tolower(c); });
  return out;
}

Status halfVertex(std::size_t line, std::string_view text) {
  return invalid("file", "line " + std::to_string(line) + ": '" + std::string(text.substr(0, 60)) +
                             "' does not have the 3 numbers that a vertex needs; export the file again");
}

}  // namespace

bool isStlText(std::string_view bytes) {
  const std::string_view head = bytes.substr(0, 512);
  return lowerCase(trimmed(withoutByteOrderMark(head)).substr(0, 5)) == "solid" && head.find('\0') == std::string::npos;
}

Expected<std::string> plainStl(std::string_view text) {
  std::string out;
  std::string solid;  // written before its first facet
  std::size_t facets = 0;
  Lines lines(withoutByteOrderMark(text));
  for (std::string_view line; lines.next(line);) {
    line = trimmed(line);
    if (line.empty()) continue;
    const std::string keyword = lowerCase(line.substr(0, line.find_first_of(" \t")));
    if (keyword == "solid") {
      solid = keyword + std::string(line.substr(5)) + '\n';
    } else if (keyword == "endsolid") {
      if (solid.empty()) out += keyword + std::string(line.substr(8)) + '\n';
      solid.clear();
    } else {
      out += solid + lowerCase(line) + '\n';
      solid.clear();
      if (keyword == "facet") ++facets;
      const bool half = keyword == "vertex" && countNumbers(wordsOf(line), 1, 3) < 3;
      if (half) return halfVertex(lines.number(), line);
    }
  }
  if (facets == 0) return invalid("file", "the file has no facet; export it with facets");
  return out;
}

}  // namespace lpv::cli
