#pragma once
// Rewrites glTF 2.0 so that Assimp reads it right.

#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "import/gltf_extras.h"

namespace lpv::cli {

struct PlainGltf {
  std::string bytes;  ///< binary glTF 2.0; of a glTF 1.0 file, the file as it is
  bool rewritten = true;
  GltfExtras extras;
  std::vector<std::string> warnings;
};

/// The same scene as one binary glTF file without extensions, animations and skins, whose meshes hold floats and
/// uint32. `isBinary`: the file is a .glb; `folder`: where its other files are. INVALID_ARGUMENT, with the place, for
/// JSON that is not glTF 2.0, an index out of range, a missing file, and a required extension that is not known.
Expected<PlainGltf> plainGltf(std::string_view bytes, bool isBinary, const std::string& folder);

}  // namespace lpv::cli
