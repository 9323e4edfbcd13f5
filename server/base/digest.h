#pragma once

#include <string>

namespace lpv {

/// SHA-256 in lower-case hexadecimal.
std::string sha256(const std::string& bytes);

}  // namespace lpv
