#pragma once
// Encodes frames as image files in memory.

#include <cstdint>
#include <glm/glm.hpp>
#include <string>
#include <vector>

#include "base/status.h"

namespace lpv::encode {

/// 8-bit RGB, rows from the top. `quality` 1..100.
Expected<std::string> jpeg(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb, int quality);
/// Lossless sRGB, compression level 1: encoding time matters more than size.
Expected<std::string> png(const glm::ivec2& size, const std::vector<std::uint8_t>& rgb);
/// Linear float32 RGB, ZIP-compressed.
Expected<std::string> exr(const glm::ivec2& size, const std::vector<float>& rgb);

}  // namespace lpv::encode
