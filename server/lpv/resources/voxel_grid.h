#pragma once
// The cells that one light is voxelized in for VPLs (MATHS.md 3b): its own, so that it need not lie in the field's grid
// nor be as large as its cells.

#include <glm/glm.hpp>

#include "lpv/resources/cell_box.h"
#include "lpv/resources/lights.h"

namespace lpv {

/// Cells of edge 2^n field cells, on the lattice of such cells that begins where the field does.
struct VoxelGrid {
  glm::dvec3 lower{0.0};  ///< where cell (0, 0, 0) begins, in cells of its own, whole
  double cell = 1.0;  ///< edge, cells of the field
  glm::ivec3 dims{0};
  CellBox box;  ///< the cells that the light can touch

  bool operator==(const VoxelGrid&) const = default;

  /// In cells of the field.
  glm::dvec3 origin() const { return lower * cell; }
  /// Cell units of this grid, from those of the field.
  glm::dmat4 fromField() const;
};

/// Blocks of the tree lie as they would if the grid began where the field does: `lower` is a multiple of this.
inline constexpr int kVoxelAlignment = 128;
/// Cells of the box of a light, at most: above, its cells are larger than the field's. A field of 128^3 with what
/// moves in it.
inline constexpr double kMostVoxels = 130.0 * 130.0 * 130.0;
inline constexpr double kMostVoxelsAcross = 256.0;

/// The field's own cells, but smaller for a light that has few of them across and is no list of polygons to receivers
/// near it, and larger for one that has too many. Their size does not change while the light is moved or turned, except
/// where that needs more than kMostVoxels.
VoxelGrid voxelGridFor(const EmittingLight& light);

/// The field's own cells, and nothing of the light beyond them.
VoxelGrid fieldVoxels(const EmittingLight& light, const glm::ivec3& dims);

}  // namespace lpv
