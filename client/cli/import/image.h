#pragma once
// Image files to textures.

#include <glm/glm.hpp>
#include <string>

#include "base/status.h"
#include "scene/texture.h"

namespace lpv::cli {

/// Any format OpenImageIO reads. 8-bit images stay sRGB bytes; deeper integers are decoded to linear halves; floating
/// point images are linear: halves where their range suffices. One or two channels are grey; alpha is ignored and
/// does not darken the colours; negative and not finite texels become 0.
Expected<Texture> readImage(const std::string& path);

/// The same from a file's bytes in memory; `format` is a file extension without the dot ("png").
Expected<Texture> decodeImage(const std::string& bytes, const std::string& format);

/// Mean of the linear texels.
glm::dvec3 meanColour(const Texture& texture);

}  // namespace lpv::cli
