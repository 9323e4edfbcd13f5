#pragma once
// Scene files in the form that Assimp reads right.

#include <assimp/DefaultIOSystem.h>

#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "import/gltf_extras.h"

namespace lpv::cli {

struct PreparedFile {
  std::string name;   ///< the path, whose extension tells Assimp the format of `bytes`
  std::string bytes;
  GltfExtras extras;  ///< of glTF
  std::vector<std::string> warnings;
};

/// Reads, checks and, where its format needs it, rewrites a file (plainObj, plainPly, plainStl, plainGltf).
Expected<PreparedFile> prepareFile(const std::string& path);

/// Gives Assimp a prepared file's bytes, and the material files beside an OBJ as plainMtl writes them.
class PreparedFileSystem : public Assimp::DefaultIOSystem {
 public:
  explicit PreparedFileSystem(const PreparedFile& file) : file_(file) {}
  bool Exists(const char* name) const override;
  Assimp::IOStream* Open(const char* name, const char* mode) override;

 private:
  const PreparedFile& file_;
};

}  // namespace lpv::cli
