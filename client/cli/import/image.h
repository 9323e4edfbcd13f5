#pragma once
// Reads image files as textures.

#include <glm/glm.hpp>
#include <string>

#include "base/status.h"
#include "import/image_reader.h"
#include "scene/texture.h"

namespace lpv::cli {

/// Reads any format that OpenImageIO reads. 8-bit images stay sRGB bytes; deeper integers become linear halves;
/// floating point images are taken as linear, stored as halves if their range suffices. One or two channels are grey.
/// Alpha is not multiplied in; with kColourWithAlpha an image of integers with some alpha below 1 becomes 8 bits with
/// alpha, else alpha is dropped. Integers of kNumbers are linear, and stay bytes where they are. Texels that are
/// negative or not finite become 0.
Expected<Texture> readImage(const std::string& path, ImageUse use = ImageUse::kColour);

/// Reads an image file held in memory; `format` is a file extension without the dot ("png").
Expected<Texture> decodeImage(const std::string& bytes, const std::string& format, ImageUse use = ImageUse::kColour);

/// Mean of the texels, linear.
glm::dvec3 meanColour(const Texture& texture);

}  // namespace lpv::cli
