#pragma once
// Rewrites text STL so that Assimp reads it right.

#include <string>
#include <string_view>

#include "base/status.h"

namespace lpv::cli {

/// True for a text STL: it begins with "solid" in any case, and has no zero byte near its beginning.
bool isStlText(std::string_view bytes);

/// The same file with its keywords in lower case and without solids that have no facet, neither of which Assimp 5.2
/// reads right. INVALID_ARGUMENT, with the line, for a vertex without three numbers, and for a file without facets.
Expected<std::string> plainStl(std::string_view text);

}  // namespace lpv::cli
