#pragma once
// Checks PLY files, and rewrites those that Assimp does not read.

#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::cli {

/// The file as it is, or, if its faces come before its vertices or it has triangle strips, the same vertices and faces
/// in the order and the form that Assimp 5.2 reads. INVALID_ARGUMENT for a file that is cut short, for a vertex index
/// out of range (with the face), and for a file without faces.
Expected<std::string> plainPly(std::string_view bytes);

}  // namespace lpv::cli
