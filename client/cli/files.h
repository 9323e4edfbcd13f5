#pragma once
// Files that commands read and write whole; "-" is a standard stream.

#include <string>

#include "command.h"

namespace lpv::cli {

/// The path that means stdout where a file is written and stdin where one is read.
inline constexpr const char* kStandardStream = "-";
inline bool isStandardStream(const std::string& path) { return path == kStandardStream; }

/// Writes a temporary file and renames it, so that `path` is either complete or unchanged; "-": stdout.
Status writeFile(const std::string& path, const std::string& bytes);

/// All bytes of a file; "-": of stdin. `field`: of the error.
Expected<std::string> readFile(const std::string& path, const std::string& field);

/// Refuses, as a usage error, to write binary data to stdout beside --json's object or onto a terminal.
void checkBinaryOutput(const Context& context, const std::string& command, const std::string& path);

}  // namespace lpv::cli
