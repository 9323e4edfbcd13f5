#pragma once

#include <string>

#include "scene/scene.h"

namespace lpv::bench {

/// The surfaces of a glTF binary of plain meshes (no transforms, 16-bit indices, floats without stride), with a lamp of
/// 1 m below the middle of the ceiling, in a grid around all of it; exits with a message where it is anything else.
Scene gltfRoom(const std::string& path, int cells);

}  // namespace lpv::bench
