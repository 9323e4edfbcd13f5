#pragma once
// The materials of a glTF file, with what a light or a surface can use of them.

#include <functional>
#include <string>
#include <vector>

#include "import/gltf_data.h"

namespace lpv::cli {

/// Appends bytes to the rewritten file and returns the index of their buffer view.
using AddView = std::function<std::size_t(std::string_view bytes)>;

/// Writes the members materials, textures and images; images inside the file move with `addView`. What is left out is
/// said in `warnings`.
void addPlainMaterials(const JsonPlace& root, GltfData& data, const AddView& addView, nlohmann::json& out,
                       std::vector<std::string>& warnings);

}  // namespace lpv::cli
