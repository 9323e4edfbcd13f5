#include "import/ply_header.h"

#include <algorithm>
#include <charconv>

#include "import/text_lines.h"

namespace lpv::cli {
namespace {

PlyType typeNamed(std::string_view name) {
  if (name == "char" || name == "int8") return {1, false, true};
  if (name == "uchar" || name == "uint8") return {1, false, false};
  if (name == "short" || name == "int16") return {2, false, true};
  if (name == "ushort" || name == "uint16") return {2, false, false};
  if (name == "int" || name == "int32") return {4, false, true};
  if (name == "uint" || name == "uint32") return {4, false, false};
  if (name == "float" || name == "float32") return {4, true, true};
  if (name == "double" || name == "float64") return {8, true, true};
  return {};
}

bool readElement(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (words.size() < 3) return false;
  PlyElement& element = header.elements.emplace_back();
  element.name = words[1];
  const char* const end = words[2].data() + words[2].size();
  const auto [stop, error] = std::from_chars(words[2].data(), end, element.count);
  return error == std::errc() && stop == end;
}

bool readProperty(const std::vector<std::string_view>& words, PlyHeader& header) {
  if (header.elements.empty() || words.size() < 3) return false;
  PlyProperty& property = header.elements.back().properties.emplace_back();
  if (words[1] != "list") {
    property.type = typeNamed(words[1]);
    property.name = words[2];
    return property.type.bytes != 0;
  }
  if (words.size() < 5) return false;
  property.count = typeNamed(words[2]);
  property.type = typeNamed(words[3]);
  property.name = words[4];
  return property.count->bytes != 0 && property.type.bytes != 0;
}

bool readLine(std::string_view line, PlyHeader& header) {
  const std::vector<std::string_view> words = wordsOf(line);
  if (words.empty()) return true;
  if (words[0] == "format" && words.size() > 1) {
    header.format = words[1];
    return header.format == "ascii" || header.format == "binary_little_endian" || header.format == "binary_big_endian";
  }
  bool read = true;  // comment, obj_info
  if (words[0] == "element") read = readElement(words, header);
  if (words[0] == "property") read = readProperty(words, header);
  if (read && (words[0] == "element" || words[0] == "property"))
    header.elements.back().header += std::string(line) + '\n';
  return read;
}

}  // namespace

bool PlyElement::hasLists() const {
  return std::any_of(properties.begin(), properties.end(), [](const PlyProperty& p) { return p.count.has_value(); });
}

std::uint64_t PlyElement::leastBytes() const {
  std::uint64_t bytes = 0;
  for (const PlyProperty& property : properties) bytes += property.count ? property.count->bytes : property.type.bytes;
  return bytes;
}

std::optional<PlyHeader> readPlyHeader(std::string_view text) {
  PlyHeader header;
  Lines lines(text);
  std::string_view line;
  if (!lines.next(line) || trimmed(line) != "ply") return {};
  while (lines.next(line)) {
    if (trimmed(line) == "end_header") {
      header.bytes = lines.position();
      return header.format.empty() ? std::nullopt : std::optional(header);
    }
    if (!readLine(trimmed(line), header)) return {};
  }
  return {};
}

}  // namespace lpv::cli
