#pragma once
// Rewrites OBJ and MTL so that Assimp reads them right.

#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::cli {

/// The same file without byte order mark, indentation, comments after data, continued lines and numbers without a
/// leading zero, none of which Assimp 5.2 reads right. INVALID_ARGUMENT, with the line, for an index that is malformed
/// or out of range, and for a file without faces.
Expected<std::string> plainObj(std::string_view text);

/// The same material file without byte order mark and indentation.
std::string plainMtl(std::string_view text);

}  // namespace lpv::cli
