#include "import/prepared_file.h"

#include <assimp/MemoryIOWrapper.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <utility>

#include "import/file_check.h"
#include "import/gltf_file.h"
#include "import/obj_text.h"
#include "import/ply_file.h"
#include "import/stl_text.h"

namespace lpv::cli {
namespace {

std::string contentOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

Expected<std::string> plainBytes(const std::string& extension, std::string bytes) {
  if (extension == "obj") return plainObj(bytes);
  if (extension == "ply") return plainPly(bytes);
  if (isStlText(bytes)) return plainStl(bytes);
  return bytes;
}

Status prepareGltf(const std::string& path, PreparedFile& file) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  Expected<PlainGltf> plain = plainGltf(file.bytes, extensionOf(path) == "glb", folder);
  if (!plain) return plain.status();
  if (plain->rewritten) file.name = std::filesystem::path(path).replace_extension(".glb").string();
  file.bytes = std::move(plain->bytes);
  file.extras = std::move(plain->extras);
  file.warnings = std::move(plain->warnings);
  return {};
}

Status prepareOther(const std::string& extension, PreparedFile& file) {
  Expected<std::string> bytes = plainBytes(extension, std::move(file.bytes));
  if (bytes) file.bytes = std::move(*bytes);
  return bytes.status();
}

/// A stream that owns a copy of its text.
Assimp::IOStream* streamOf(const std::string& text) {
  auto copy = std::make_unique<std::uint8_t[]>(std::max<std::size_t>(1, text.size()));
  std::copy(text.begin(), text.end(), copy.get());
  return new Assimp::MemoryIOStream(copy.release(), text.size(), true);  // Assimp deletes it
}

}  // namespace

Expected<PreparedFile> prepareFile(const std::string& path) {
  if (Status status = checkSceneFile(path); !status.ok()) return status;
  PreparedFile file;
  file.name = path;
  file.bytes = contentOf(path);
  const std::string extension = extensionOf(path);
  const bool gltf = extension == "glb" || extension == "gltf";
  const Status status = gltf ? prepareGltf(path, file) : prepareOther(extension, file);
  if (!status.ok()) return Status(status.code(), path + ": " + status.message(), status.field());
  return file;
}

bool PreparedFileSystem::Exists(const char* name) const { return name == file_.name || DefaultIOSystem::Exists(name); }

Assimp::IOStream* PreparedFileSystem::Open(const char* name, const char* mode) {
  if (name == file_.name) {
    return new Assimp::MemoryIOStream(reinterpret_cast<const std::uint8_t*>(file_.bytes.data()), file_.bytes.size());
  }
  if (extensionOf(file_.name) != "obj") return DefaultIOSystem::Open(name, mode);
  std::error_code error;
  return std::filesystem::is_regular_file(name, error) ? streamOf(plainMtl(contentOf(name))) : nullptr;
}

}  // namespace lpv::cli
