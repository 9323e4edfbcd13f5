#include "import/file_check.h"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "import/stl_text.h"

namespace lpv::cli {
namespace {

Status broken(const std::string& path, const std::string& why) { return invalid("file", path + ": " + why); }

Status cutShort(const std::string& path, std::uint64_t size, std::uint64_t wanted) {
  return broken(path, "the file is cut short: " + std::to_string(size) + " bytes, its header announces " +
                          std::to_string(wanted) + "; copy or export it again");
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
  if (head.size() < 20 || head.compare(0, 4, "glTF") != 0)
    return broken(path, "it does not begin as binary glTF does; name it .gltf if it is text, else export it again");
  if (uint32At(head, 4) != 2) {
    return broken(
        path, "binary glTF version " + std::to_string(uint32At(head, 4)) + "; only version 2 can be read: convert it");
  }
  if (size < uint32At(head, 8)) return cutShort(path, size, uint32At(head, 8));
  if (head.compare(16, 4, "JSON") != 0) return broken(path, "its first chunk is not JSON; export it again");
  if (std::uint64_t(uint32At(head, 12)) + 20 > size) return cutShort(path, size, uint32At(head, 12) + 20ULL);
  return {};
}

std::string lowerCase(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::tolower(c); });
  return text;
}

Status checkStl(const std::string& path, std::uint64_t size) {
  const std::string head = firstBytes(path, 512);
  if (!isStlText(head)) {
    const std::uint64_t wanted = 84 + 50ULL * uint32At(head, 80);
    if (size < 84) return cutShort(path, size, 84);
    if (size < wanted) return cutShort(path, size, wanted);
    return wanted > 84 ? Status() : broken(path, "the file has no facet; export it with facets");
  }
  std::ifstream file(path, std::ios::binary);
  file.seekg(-std::streamoff(std::min<std::uint64_t>(size, 512)), std::ios::end);
  const std::string tail((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  const bool ends = lowerCase(tail).find("endsolid") != std::string::npos;
  return ends ? Status() : broken(path, "the file is cut short: it has no endsolid; copy or export it again");
}

}  // namespace

std::string extensionOf(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  if (!extension.empty()) extension.erase(0, 1);
  return lowerCase(extension);
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
  return {};
}

}  // namespace lpv::cli
