#include "import/image.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace lpv::cli {
namespace {

struct Reader {
  ReadImage* read = nullptr;
  std::string error;
};

/// Loads the module beside this program, built or installed. Loading takes most of a second, so it happens when the
/// first image is read.
Reader loadReader() {
  std::error_code error;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", error);
  const std::filesystem::path module = program.parent_path() / LPV_MODULE_FOLDER / "lpv_images.so";
  void* handle = dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (handle == nullptr) return {nullptr, dlerror()};
  auto* read = reinterpret_cast<ReadImage*>(dlsym(handle, "lpvReadImage"));
  return {read, read == nullptr ? "it belongs to another version of lpvctl" : ""};
}

/// Redirects stderr to /dev/null while it lives: image libraries write there about bad files; we report one line.
class QuietStderr {
 public:
  QuietStderr() : kept_(dup(STDERR_FILENO)) {
    const int null = open("/dev/null", O_WRONLY | O_CLOEXEC);
    if (kept_ >= 0 && null >= 0) dup2(null, STDERR_FILENO);
    if (null >= 0) close(null);
  }
  ~QuietStderr() {
    if (kept_ < 0) return;
    dup2(kept_, STDERR_FILENO);
    close(kept_);
  }
  QuietStderr(const QuietStderr&) = delete;
  QuietStderr& operator=(const QuietStderr&) = delete;

 private:
  int kept_;
};

Expected<Texture> read(const std::string& name, const std::string* bytes, ImageUse use) {
  static const Reader reader = loadReader();
  if (reader.read == nullptr) return Status(Code::kInternal, "the image module cannot be loaded: " + reader.error);
  const QuietStderr quiet;
  Expected<Texture> out = Texture();
  reader.read(name, bytes, use, out);
  return out;
}

}  // namespace

Expected<Texture> readImage(const std::string& path, ImageUse use) { return read(path, nullptr, use); }

Expected<Texture> decodeImage(const std::string& bytes, const std::string& format, ImageUse use) {
  return read("embedded." + format, &bytes, use);
}

glm::dvec3 meanColour(const Texture& texture) {
  glm::dvec3 sum(0.0);
  std::vector<glm::vec3> row;
  for (int y = 0; y < texture.height; ++y) {
    row.clear();
    appendLinearRow(texture, y, row);
    for (const glm::vec3& texel : row) sum += glm::dvec3(texel);
  }
  return sum / std::max(1.0, double(texture.width) * texture.height);
}

}  // namespace lpv::cli
