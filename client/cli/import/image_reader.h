#pragma once
// The interface of the module lpv_images, exported as "lpvReadImage".

#include <string>

#include "base/status.h"
#include "scene/texture.h"

namespace lpv::cli {

/// What becomes of an image's alpha.
enum class ImageAlpha { kDrop, kKeep };

/// Reads the file `name`, or `bytes` as a file with the extension of `name`.
using ReadImage = void(const std::string& name, const std::string* bytes, ImageAlpha alpha, Expected<Texture>& out);

}  // namespace lpv::cli
