#include "import/ply_file.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstring>

#include "import/ply_header.h"
#include "import/text_lines.h"

namespace lpv::cli {
namespace {

using Corners = std::vector<std::int64_t>;

Status cutShort(const std::string& element, std::uint64_t found, std::uint64_t announced) {
  return invalid("file", "the file is cut short: " + std::to_string(found) + " complete elements of '" + element +
                             "', its header announces " + std::to_string(announced) + "; copy or export it again");
}

/// Where an element lies in the file, and what its lists of vertices hold.
struct Body {
  std::string_view bytes;
  std::vector<Corners> lists;  ///< of faces and triangle strips
};

bool listsVertices(const PlyElement& element) { return element.name == "face" || element.name == "tristrips"; }

bool isVertexList(const PlyElement& element, const PlyProperty& property) {
  return property.count && listsVertices(element) &&
         (property.name == "vertex_indices" || property.name == "vertex_index");
}

double valueAt(const char* at, PlyType type, bool bigEndian) {
  char bytes[8] = {};
  std::memcpy(bytes, at, type.bytes);
  if (bigEndian) std::reverse(bytes, bytes + type.bytes);
  const auto as = [&](auto value) {
    std::memcpy(&value, bytes, sizeof(value));
    return double(value);
  };
  if (type.real) return type.bytes == 4 ? as(0.0F) : as(0.0);
  if (type.bytes == 1) return type.isSigned ? as(std::int8_t()) : as(std::uint8_t());
  if (type.bytes == 2) return type.isSigned ? as(std::int16_t()) : as(std::uint16_t());
  return type.isSigned ? as(std::int32_t()) : as(std::uint32_t());
}

/// A number that may be an index; -2^31 for what no index can be.
std::int64_t whole(double value) {
  return std::abs(value) < 4294967296.0 && value == std::floor(value) ? std::int64_t(value) : -2147483648LL;
}

/// Takes elements off a binary body.
class BinaryBody {
 public:
  BinaryBody(std::string_view bytes, bool bigEndian) : bytes_(bytes), bigEndian_(bigEndian) {}

  Status take(const PlyElement& element, Body& body) {
    const std::size_t begin = at_;
    const std::uint64_t least = std::max<std::uint64_t>(1, element.leastBytes());
    const std::uint64_t possible = (bytes_.size() - at_) / least;
    if (element.count > possible) return cutShort(element.name, possible, element.count);
    if (!element.hasLists()) at_ += element.count * element.leastBytes();
    for (std::uint64_t i = 0; element.hasLists() && i < element.count; ++i) {
      if (!takeOne(element, body)) return cutShort(element.name, i, element.count);
    }
    body.bytes = bytes_.substr(begin, at_ - begin);
    return {};
  }

 private:
  bool takeOne(const PlyElement& element, Body& body) {
    for (const PlyProperty& property : element.properties) {
      std::int64_t items = 1;
      if (property.count) {
        if (bytes_.size() - at_ < property.count->bytes) return false;
        items = whole(valueAt(bytes_.data() + at_, *property.count, bigEndian_));
        at_ += property.count->bytes;
      }
      if (items < 0 || (bytes_.size() - at_) / property.type.bytes < std::size_t(items)) return false;
      if (isVertexList(element, property)) body.lists.push_back(corners(property.type, std::size_t(items)));
      at_ += std::size_t(items) * property.type.bytes;
    }
    return true;
  }

  Corners corners(PlyType type, std::size_t items) const {
    Corners out(items);
    for (std::size_t i = 0; i < items; ++i)
      out[i] = whole(valueAt(bytes_.data() + at_ + i * type.bytes, type, bigEndian_));
    return out;
  }

  std::string_view bytes_;
  bool bigEndian_;
  std::size_t at_ = 0;
};

std::int64_t indexFrom(std::string_view word) {
  double value = -0.5;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  return error == std::errc() && end == word.data() + word.size() ? whole(value) : -2147483648LL;
}

/// Takes elements off a text body: one line each.
class TextBody {
 public:
  explicit TextBody(std::string_view text) : text_(text), lines_(text) {}

  Status take(const PlyElement& element, Body& body) {
    const std::size_t begin = lines_.position();
    for (std::uint64_t i = 0; i < element.count; ++i) {
      std::string_view line;
      do {
        if (!lines_.next(line)) return cutShort(element.name, i, element.count);
      } while (trimmed(line).empty());
      if (!takeLine(element, wordsOf(line), body)) {
        return invalid("file", "'" + element.name + "' " + std::to_string(i) + ": the line '" +
                                   std::string(trimmed(line).substr(0, 60)) +
                                   "' has fewer numbers than its header announces; the file is cut short or "
                                   "damaged: copy or export it again");
      }
    }
    body.bytes = text_.substr(begin, lines_.position() - begin);
    return {};
  }

 private:
  static bool takeLine(const PlyElement& element, const std::vector<std::string_view>& words, Body& body) {
    std::size_t at = 0;
    for (const PlyProperty& property : element.properties) {
      if (at >= words.size() || !looksLikeNumber(words[at])) return false;
      const std::int64_t items = property.count ? indexFrom(words[at++]) : 1;
      if (items < 0 || words.size() - at < std::size_t(items)) return false;
      if (isVertexList(element, property)) {
        Corners& corners = body.lists.emplace_back();
        for (std::size_t i = 0; i < std::size_t(items); ++i) corners.push_back(indexFrom(words[at + i]));
      }
      at += std::size_t(items);
    }
    return true;
  }

  std::string_view text_;
  Lines lines_;
};

Status checkCorners(const PlyElement& element, const Body& body, std::uint64_t vertices) {
  for (std::size_t i = 0; i < body.lists.size(); ++i) {
    for (const std::int64_t corner : body.lists[i]) {
      if (corner >= 0 ? std::uint64_t(corner) < vertices : corner == -1 && element.name == "tristrips") continue;
      const std::string index =
          corner == -2147483648LL ? "an index that is no whole number" : "vertex " + std::to_string(corner);
      return invalid("file", element.name + " " + std::to_string(i) + ": " + index + " is out of range; the file has " +
                                 std::to_string(vertices) + " vertices, numbered from 0; export it again");
    }
  }
  return {};
}

/// Appends the triangles of a strip; every second one is wound the other way round, -1 begins another strip.
void appendStrip(const Corners& strip, std::vector<Corners>& triangles) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < strip.size(); ++i) {
    if (strip[i] < 0) begin = i + 1;
    if (strip[i] < 0 || i < begin + 2) continue;
    const bool odd = (i - begin) % 2 == 1;
    triangles.push_back({strip[i - (odd ? 1 : 2)], strip[i - (odd ? 2 : 1)], strip[i]});
  }
}

void appendNumber(std::string& out, std::int64_t value, bool text, bool bigEndian) {
  if (text) {
    out += std::to_string(value) + ' ';
    return;
  }
  auto bits = std::uint32_t(value);
  if (bigEndian) bits = __builtin_bswap32(bits);
  out.append(reinterpret_cast<const char*>(&bits), sizeof(bits));
}

/// Faces and strips as one element of faces.
std::string facesBody(const std::vector<Corners>& faces, const PlyHeader& header) {
  std::string out;
  const bool bigEndian = header.format == "binary_big_endian";
  for (const Corners& face : faces) {
    appendNumber(out, std::int64_t(face.size()), header.isText(), bigEndian);
    for (const std::int64_t corner : face) appendNumber(out, corner, header.isText(), bigEndian);
    if (header.isText()) out += '\n';
  }
  return out;
}

const std::string kFaceList = "property list int int vertex_indices\n";

/// The vertices first, then all faces.
std::string rewritten(const PlyHeader& header, const std::vector<Body>& bodies) {
  std::string vertexHeader;
  std::string_view vertices;
  std::vector<Corners> faces;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (header.elements[i].name == "vertex") vertexHeader = header.elements[i].header;
    if (header.elements[i].name == "vertex") vertices = bodies[i].bytes;
    const bool strips = header.elements[i].name == "tristrips";
    for (const Corners& list : bodies[i].lists) {
      if (strips) appendStrip(list, faces);
      if (!strips) faces.push_back(list);
    }
  }
  return "ply\nformat " + header.format + " 1.0\n" + vertexHeader + "element face " + std::to_string(faces.size()) +
         "\n" + kFaceList + "end_header\n" + std::string(vertices) + (header.isText() ? "\n" : "") +
         facesBody(faces, header);
}

/// Whether Assimp 5.2 reads the elements in this order: it wants vertices first and ignores strips.
bool needsRewriting(const PlyHeader& header) {
  bool vertices = false;
  for (const PlyElement& element : header.elements) {
    vertices = vertices || element.name == "vertex";
    if (element.name == "tristrips" || (element.name == "face" && !vertices)) return true;
  }
  return false;
}

template <typename Reader>
Status takeAll(const PlyHeader& header, Reader reader, std::vector<Body>& bodies) {
  std::uint64_t vertices = 0;
  for (const PlyElement& element : header.elements) {
    if (Status status = reader.take(element, bodies.emplace_back()); !status.ok()) return status;
    if (element.name == "vertex") vertices = element.count;
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (Status status = checkCorners(header.elements[i], bodies[i], vertices); !status.ok()) return status;
  }
  return {};
}

}  // namespace

Expected<std::string> plainPly(std::string_view bytes) {
  bytes = withoutByteOrderMark(bytes);
  const std::optional<PlyHeader> header = readPlyHeader(bytes);
  if (!header)
    return invalid("file", "its PLY header is not complete, or names a format or a type that PLY does not have");
  std::vector<Body> bodies;
  const std::string_view body = bytes.substr(header->bytes);
  Status status = header->isText() ? takeAll(*header, TextBody(body), bodies)
                                   : takeAll(*header, BinaryBody(body, header->format == "binary_big_endian"), bodies);
  if (!status.ok()) return status;
  const bool faces = std::any_of(bodies.begin(), bodies.end(), [](const Body& b) { return !b.lists.empty(); });
  if (!faces) return invalid("file", "the file has no face, only vertices; export it with faces");
  return needsRewriting(*header) ? rewritten(*header, bodies) : std::string(bytes);
}

}  // namespace lpv::cli
