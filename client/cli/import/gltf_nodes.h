#pragma once
// The nodes of a glTF file.

#include <cstddef>
#include <vector>

#include "import/gltf_json.h"

namespace lpv::cli {

/// The roots of the file's scene. A file without scenes shows the nodes that are nobody's children. Makes the file's
/// problem of an index out of range, a node that is reached twice and a tree of more than 1000 levels.
std::vector<std::size_t> rootNodes(const JsonPlace& root);

/// The nodes with their names, meshes, cameras, children and transforms.
nlohmann::json plainNodes(const JsonPlace& root);

}  // namespace lpv::cli
