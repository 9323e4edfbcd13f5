#pragma once
// Detects truncated files by their own headers, before a parser guesses at the rest.

#include <string>

#include "base/status.h"

namespace lpv::cli {

/// The lower-case extension without the dot.
std::string extensionOf(const std::string& path);

/// INVALID_ARGUMENT if the file cannot be read, its extension is none of glb, gltf, obj, ply, stl, or its size is less
/// than its header announces (GLB, binary STL).
Status checkSceneFile(const std::string& path);

}  // namespace lpv::cli
