#pragma once
// Names of objects as the server takes them.

#include <string>

namespace lpv::cli {

/// A valid object name made from a file's node, else its mesh, else the file's own name: 1..200 bytes of printable
/// UTF-8 without '/'. Names that importers make up ("<STL_BINARY>", "defaultobject") count as none.
std::string objectName(const std::string& node, const std::string& mesh, const std::string& fileStem);

}  // namespace lpv::cli
