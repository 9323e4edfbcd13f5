#pragma once
// The interface of the module lpv_images, exported as "lpvReadImage".

#include <string>

#include "base/status.h"
#include "scene/texture.h"

namespace lpv::cli {

/// What an image is of.
enum class ImageUse {
  kColour,           ///< alpha is dropped
  kColourWithAlpha,
  kNumbers,          ///< integers are linear
};

/// Reads the file `name`, or `bytes` as a file with the extension of `name`.
using ReadImage = void(const std::string& name, const std::string* bytes, ImageUse use, Expected<Texture>& out);

}  // namespace lpv::cli
