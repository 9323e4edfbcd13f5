#pragma once

#include <cstddef>
#include <string>

#include "base/status.h"

namespace lpv {

/// Checks the name of an object or a group: `least` to `most` bytes without control characters or '/'.
Status checkWords(const char* field, const std::string& words, std::size_t least, std::size_t most);

}  // namespace lpv
