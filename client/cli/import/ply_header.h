#pragma once
// The header of a PLY file.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace lpv::cli {

struct PlyType {
  std::size_t bytes = 0;  ///< 0: not a type
  bool real = false;
  bool isSigned = false;
};

struct PlyProperty {
  std::string name;
  PlyType type;                  ///< of the value, or of a list's items
  std::optional<PlyType> count;  ///< of a list's length; none: a single value
};

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::vector<PlyProperty> properties;
  std::string header;  ///< its lines of the header

  bool hasLists() const;
  /// Of one element: bytes in a binary file, words in a text file, with its lists empty.
  std::uint64_t leastBytes() const;
  std::uint64_t leastWords() const { return properties.size(); }
};

struct PlyHeader {
  std::string format;  ///< ascii, binary_little_endian or binary_big_endian
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;  ///< where the body begins

  bool isText() const { return format == "ascii"; }
};

/// None if the header is not complete or names an unknown type or format.
std::optional<PlyHeader> readPlyHeader(std::string_view text);

}  // namespace lpv::cli
