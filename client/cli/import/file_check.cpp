#include "import/file_check.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <vector>

namespace lpv::cli {
namespace {

Status broken(const std::string& path, const std::string& why) { return invalid("file", path + ": " + why); }

Status cutShort(const std::string& path, std::uint64_t size, std::uint64_t wanted) {
  return broken(path, "the file is cut short: " + std::to_string(size) + " bytes, its header announces " +
                          std::to_string(wanted));
}

std::string firstBytes(const std::string& path, std::size_t count) {
  std::ifstream file(path, std::ios::binary);
  std::string bytes(count, '\0');
  file.read(bytes.data(), std::streamsize(count));
  bytes.resize(std::size_t(std::max<std::streamsize>(file.gcount(), 0)));
  return bytes;
}

std::uint32_t uint32At(const std::string& bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

Status checkGlb(const std::string& path, std::uint64_t size) {
  const std::string head = firstBytes(path, 20);
  if (head.size() < 20 || head.compare(0, 4, "glTF") != 0) return broken(path, "not a binary glTF file");
  if (uint32At(head, 4) != 2) {
    return broken(path, "binary glTF version " + std::to_string(uint32At(head, 4)) + "; only version 2 can be read");
  }
  if (size < uint32At(head, 8)) return cutShort(path, size, uint32At(head, 8));
  if (head.compare(16, 4, "JSON") != 0) return broken(path, "its first chunk is not JSON");
  if (std::uint64_t(uint32At(head, 12)) + 20 > size) return cutShort(path, size, uint32At(head, 12) + 20ULL);
  return {};
}

/// A text STL begins with "solid" and has no zero byte. Some binary ones begin so too, but their size is exact.
Status checkStl(const std::string& path, std::uint64_t size) {
  const std::string head = firstBytes(path, 512);
  const std::uint64_t wanted = 84 + 50ULL * uint32At(head, 80);
  const bool text = head.compare(0, 5, "solid") == 0 && head.find('\0') == std::string::npos;
  if (!text && size < 84) return cutShort(path, size, 84);
  if (!text && size < wanted) return cutShort(path, size, wanted);
  if (!text) return {};
  std::ifstream file(path, std::ios::binary);
  file.seekg(-std::streamoff(std::min<std::uint64_t>(size, 512)), std::ios::end);
  std::string tail((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  if (tail.find("endsolid") == std::string::npos) return broken(path, "the file is cut short: it has no endsolid");
  return {};
}

struct PlyElement {
  std::string name;
  std::uint64_t count = 0;
  std::uint64_t bytes = 0;  ///< of one element, without the items of its lists
  std::size_t words = 0;    ///< of one element in a text file, without the items of its lists
  bool lists = false;
  std::uint64_t listCountBytes = 0;
  std::uint64_t listItemBytes = 0;
};

struct PlyHeader {
  std::string format;
  std::vector<PlyElement> elements;
  std::size_t bytes = 0;
};

std::uint64_t plyTypeBytes(const std::string& type) {
  if (type == "char" || type == "uchar" || type == "int8" || type == "uint8") return 1;
  if (type == "short" || type == "ushort" || type == "int16" || type == "uint16") return 2;
  if (type == "int" || type == "uint" || type == "int32" || type == "uint32" || type == "float" || type == "float32") {
    return 4;
  }
  return type == "double" || type == "float64" ? 8 : 0;
}

/// Parses one header line; false if it is malformed.
bool readPlyLine(const std::string& line, PlyHeader& header) {
  std::istringstream words(line);
  std::string word;
  words >> word;
  if (word == "format") return bool(words >> header.format);
  if (word == "element") {
    PlyElement& element = header.elements.emplace_back();
    return bool(words >> element.name >> element.count);
  }
  if (word != "property") return true;  // comment, obj_info
  std::string type;
  words >> type;
  if (header.elements.empty()) return false;
  PlyElement& element = header.elements.back();
  ++element.words;
  if (type != "list") {
    element.bytes += plyTypeBytes(type);
    return plyTypeBytes(type) != 0;
  }
  std::string countType;
  std::string itemType;
  words >> countType >> itemType;
  element.bytes += plyTypeBytes(countType);
  element.listCountBytes = plyTypeBytes(countType);
  element.listItemBytes = plyTypeBytes(itemType);
  element.lists = true;
  return element.listCountBytes != 0 && element.listItemBytes != 0;
}

bool readPlyHeader(const std::string& text, PlyHeader& header) {
  if (text.compare(0, 3, "ply") != 0) return false;
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = text.find('\n', at);
    if (end == std::string::npos) return false;
    std::string line = text.substr(at, end - at);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    at = end + 1;
    if (line == "end_header") {
      header.bytes = at;
      return true;
    }
    if (!readPlyLine(line, header)) return false;
  }
  return false;
}

/// Number of words that a line of this element needs; a list that comes first (as in faces) begins with its length.
std::size_t plyWords(const PlyElement& element, const std::string& line) {
  return element.words + (element.lists ? std::size_t(std::max(0L, std::strtol(line.c_str(), nullptr, 10))) : 0);
}

std::size_t countWords(const std::string& line) {
  std::istringstream words(line);
  return std::size_t(std::distance(std::istream_iterator<std::string>(words), std::istream_iterator<std::string>()));
}

/// Checks that the file has the lines that its header announces, each with the words of its element.
Status checkPlyText(const std::string& path, const PlyHeader& header) {
  std::ifstream file(path, std::ios::binary);
  file.seekg(std::streamoff(header.bytes));
  std::string line;
  for (const PlyElement& element : header.elements) {
    for (std::uint64_t i = 0; i < element.count; ++i) {
      do {
        if (!std::getline(file, line)) {
          return broken(path, "the file is cut short: " + std::to_string(i) + " lines of '" + element.name +
                                  "', its header announces " + std::to_string(element.count));
        }
      } while (line.find_first_not_of(" \t\r") == std::string::npos);
      if (file.eof() && countWords(line) < plyWords(element, line)) {
        return broken(path, "the file is cut short: its last line is '" + line + "'");
      }
    }
  }
  return {};
}

/// Checks that the file has at least the bytes that its header's elements need (3 corners per face).
Status checkPly(const std::string& path, std::uint64_t size) {
  PlyHeader header;
  const std::string head = firstBytes(path, 65536);
  if (!readPlyHeader(head, header)) return broken(path, "its PLY header is not complete");
  std::uint64_t wanted = header.bytes;
  for (const PlyElement& element : header.elements) {
    const std::uint64_t one = element.bytes + (element.name == "face" && element.lists ? 3 * element.listItemBytes : 0);
    if (element.count > size) return cutShort(path, size, element.count);
    wanted += element.count * one;
  }
  if (header.format == "ascii") return checkPlyText(path, header);
  return size < wanted ? cutShort(path, size, wanted) : Status();
}

}  // namespace

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension;
}

Status checkSceneFile(const std::string& path) {
  const std::string extension = extensionOf(path);
  const std::string known[] = {"glb", "gltf", "obj", "ply", "stl"};
  if (std::find(std::begin(known), std::end(known), extension) == std::end(known)) {
    return broken(path, "files of type '" + extension + "' cannot be read; only glb, gltf, obj, ply and stl");
  }
  std::error_code error;
  if (std::filesystem::is_directory(path, error)) return broken(path, "this is a folder, not a file");
  const std::uint64_t size = std::filesystem::file_size(path, error);
  if (error) return broken(path, error.message());
  if (!std::ifstream(path)) return broken(path, "the file cannot be opened");
  if (size == 0) return broken(path, "the file is empty");
  if (extension == "glb") return checkGlb(path, size);
  if (extension == "stl") return checkStl(path, size);
  if (extension == "ply") return checkPly(path, size);
  return {};
}

}  // namespace lpv::cli
