#pragma once
// KHR_draco_mesh_compression, decoded by libdraco.

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "base/status.h"
#include "import/gltf_data.h"

namespace lpv::cli {

struct DracoAttribute {
  std::uint32_t id = 0;     ///< in the compressed mesh
  bool normalised = false;  ///< what the file's accessor says: whole numbers stand for -1..1 or 0..1
};

struct DracoMesh {
  std::vector<std::uint32_t> indices;        ///< three per triangle
  std::map<std::string, Floats> attributes;  ///< by the names of glTF: POSITION ...
};

/// Whether this program was built with libdraco.
bool dracoIsBuiltIn();

/// The attributes of these names. INVALID_ARGUMENT if the bytes cannot be decoded, an
/// attribute is missing, or libdraco is not built in.
Expected<DracoMesh> decodeDraco(std::string_view bytes, const std::map<std::string, DracoAttribute>& wanted);

}  // namespace lpv::cli
