#pragma once

#include <cstddef>
#include <string>

#include "base/status.h"

namespace lpv {

/// INVALID_ARGUMENT at `field` for a text with a hidden character (base/text.h): people could not tell it from another.
Status checkVisible(const char* field, const std::string& text);

/// Checks the name of an object or a group: `least` to `most` bytes without hidden characters and '/'.
Status checkWords(const char* field, const std::string& words, std::size_t least, std::size_t most);

}  // namespace lpv
