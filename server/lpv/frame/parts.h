#pragma once
// Pictures in parts: tiles, and blocks of pixels whose points a thread, or a work-group, decides about.

#include <glm/glm.hpp>

#include "shaders/layout.h"

namespace lpv {

inline constexpr glm::ivec2 kTile(layout::kNearFieldTile), kBlock(layout::kNearFieldBlockX, layout::kNearFieldBlockY);
inline constexpr int kPointsOfBlock = layout::kNearFieldBlockX * layout::kNearFieldBlockY;
static_assert(kPointsOfBlock == 32);  // bits of a uint

/// How many of them there are across and down.
inline glm::ivec2 partsOf(const glm::ivec2& size, const glm::ivec2& part) { return (size + part - 1) / part; }

}  // namespace lpv
