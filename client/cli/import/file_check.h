#pragma once
// Files that are cut short are told from their own headers, before a parser guesses at what is left.

#include <string>

#include "base/status.h"

namespace lpv::cli {

/// The lower-case extension without the dot.
std::string extensionOf(const std::string& path);

/// INVALID_ARGUMENT for a file that cannot be read, whose extension is none of glb, gltf, obj, ply, stl, or whose size
/// is not what its header announces (GLB, binary STL, PLY).
Status checkSceneFile(const std::string& path);

}  // namespace lpv::cli
