#pragma once

#include <glm/glm.hpp>

namespace lpv {

/// Cells [lower, upper), empty where any axis is.
struct CellBox {
  glm::ivec3 lower{0};
  glm::ivec3 upper{0};

  bool operator==(const CellBox&) const = default;
  bool empty() const { return lower.x >= upper.x || lower.y >= upper.y || lower.z >= upper.z; }
  /// One more cell on each side, within the grid: as far as light gets in one iteration.
  CellBox grown(const glm::ivec3& dims, int by = 1) const;
};
}  // namespace lpv
