#pragma once
// Makes object names that the server accepts.

#include <string>

namespace lpv::cli {

/// A valid object name from the name of a file's node, else of its mesh, else of the file: 1..200 bytes of printable
/// UTF-8 without '/'. Names that importers invent ("<STL_BINARY>", "defaultobject") are skipped.
std::string objectName(const std::string& node, const std::string& mesh, const std::string& fileStem);

}  // namespace lpv::cli
