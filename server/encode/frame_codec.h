#pragma once
// Pixels to picture files in memory, through OpenImageIO.

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/status.h"

namespace lpv::encode {

/// 8-bit RGB, rows from the top. `quality` 1..100.
Expected<std::string> jpeg(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb, int quality);
/// Lossless, compression level 1: stills are made for speed, not for archives.
Expected<std::string> png(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb);
/// Linear float32 RGB, ZIP-compressed.
Expected<std::string> exr(const glm::ivec2& size, const std::vector<float>& rgb);

}  // namespace lpv::encode
