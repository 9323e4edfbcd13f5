#pragma once
// The interface of the module lpv_images, exported as "lpvReadImage".

#include <string>

#include "base/status.h"
#include "scene/texture.h"

namespace lpv::cli {

/// Reads the file `name`, or `bytes` as a file with the extension of `name`.
using ReadImage = void(const std::string& name, const std::string* bytes, Expected<Texture>& out);

}  // namespace lpv::cli
