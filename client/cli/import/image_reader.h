#pragma once
// What the module lpv_images offers, under the name "lpvReadImage".

#include <string>

#include "base/status.h"
#include "scene/texture.h"

namespace lpv::cli {

/// Reads the file `name`, or `bytes` as a file of that name's kind.
using ReadImage = void(const std::string& name, const std::string* bytes, Expected<Texture>& out);

}  // namespace lpv::cli
