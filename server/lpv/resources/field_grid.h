#pragma once
// The cells of a session's field: those of its grid, and what receivers on the grid's bounds read beyond them.

#include "lpv/resources/cell_box.h"
#include "scene/scene.h"

namespace lpv {

/// The scene's grid with `guard` cells more on each side. Lookups lie between centres of cells: without a guard those
/// within half a cell of the bounds have none on one side. Guard cells are not part of the product.
struct FieldGrid {
  Grid cells;
  int guard = 0;

  bool operator==(const FieldGrid&) const = default;

  /// The product's cells among them.
  CellBox inner() const { return {glm::ivec3(guard), cells.dims - guard}; }
};

/// Guarded where the transport is GATHER and a surface comes within half a cell of the grid's bounds; with `asked`,
/// because somebody reads guard cells, always but with PROPAGATE.
FieldGrid fieldGridOf(const Scene& scene, bool asked = false);

}  // namespace lpv
