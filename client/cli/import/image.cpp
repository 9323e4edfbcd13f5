#include "import/image.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <vector>

#include "import/image_reader.h"
#include "scene/tonemap.h"
#include "wire/half.h"

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

Expected<Texture> read(const std::string& name, const std::string* bytes) {
  static const Reader reader = loadReader();
  if (reader.read == nullptr) return Status(Code::kInternal, "the image module cannot be loaded: " + reader.error);
  const QuietStderr quiet;
  Expected<Texture> out = Texture();
  reader.read(name, bytes, out);
  return out;
}

}  // namespace

Expected<Texture> readImage(const std::string& path) { return read(path, nullptr); }

Expected<Texture> decodeImage(const std::string& bytes, const std::string& format) {
  return read("embedded." + format, &bytes);
}

glm::dvec3 meanColour(const Texture& texture) {
  const std::size_t texels = std::size_t(texture.width) * std::size_t(texture.height);
  const std::size_t values = texels * 3;
  std::vector<float> linear(values);
  if (texture.format == TexelFormat::kRgb8Srgb) {
    for (std::size_t i = 0; i < values; ++i) linear[i] = float(linearFromSrgb(texture.texels[i] / 255.0));
  } else if (texture.format == TexelFormat::kRgb16F) {
    std::vector<std::uint16_t> halves(values);
    std::memcpy(halves.data(), texture.texels.data(), values * 2);
    wire::floatsFromHalves(halves.data(), values, 1.0F, linear.data());
  } else {
    std::memcpy(linear.data(), texture.texels.data(), values * 4);
  }
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < values; i += 3) sum += glm::dvec3(linear[i], linear[i + 1], linear[i + 2]);
  return sum / double(std::max<std::size_t>(texels, 1));
}

}  // namespace lpv::cli
