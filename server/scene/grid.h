#pragma once
// The light propagation volume's grid: an axis-aligned box of cubic cells (MATHS.md 1).

#include <array>
#include <cstddef>
#include <glm/glm.hpp>

#include "base/status.h"
#include "scene/bounds.h"

namespace lpv {

/// Largest number of cells along one axis.
inline constexpr int kMaxCellsPerAxis = 128;
/// Cells left free on each side when a grid is fitted to a scene.
inline constexpr int kFitMarginCells = 2;

/// Cell (i, j, k) is the half-open box [i,i+1) x [j,j+1) x [k,k+1) of grid space, centre (i+.5, j+.5, k+.5);
/// the outer upper faces belong to the last cells. Memory order: x fastest, then y, then z.
struct Grid {
  glm::dvec3 origin{0.0};  ///< world position of the minimum corner, metres
  double cell = 1.0;       ///< edge of a cell, metres, > 0
  glm::ivec3 dims{0};      ///< cells along x, y, z; each 1..kMaxCellsPerAxis

  bool operator==(const Grid&) const = default;

  std::size_t cells() const { return std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z); }
  std::size_t index(const glm::ivec3& c) const {
    return (std::size_t(c.z) * std::size_t(dims.y) + std::size_t(c.y)) * std::size_t(dims.x) + std::size_t(c.x);
  }
  glm::dvec3 gridFromWorld(const glm::dvec3& world) const { return (world - origin) / cell; }
  glm::dvec3 worldFromGrid(const glm::dvec3& grid) const { return origin + grid * cell; }
  glm::dvec3 cellCentre(const glm::ivec3& c) const { return worldFromGrid(glm::dvec3(c) + 0.5); }
  glm::dmat4 gridFromWorldMatrix() const;
  Bounds bounds() const { return {origin, origin + glm::dvec3(dims) * cell}; }
};

/// Requested grid. At most one of `longest`, `dims` and `automatic` is set; none: 32 cells along the longest edge.
struct GridOptions {
  int longest = 0;                  ///< cells along the longest edge
  glm::ivec3 dims{0};               ///< cells along each axis
  bool automatic = false;           ///< dims follow from the session's error goal
  bool hasBounds = false;           ///< false: fitted to scene and lights
  Bounds bounds;                    ///< world box, metres, used where hasBounds

  bool operator==(const GridOptions&) const = default;
};

inline constexpr int kDefaultCellsOfLongestEdge = 32;

/// The grid for `options` over `bounds` (world metres). Cells are cubic: with `longest`, the other edges are rounded
/// up to whole cells and the maximum corner moves out; with `dims`, the cell is the largest needed along any axis.
/// INVALID_ARGUMENT for cells out of range, bounds inside out, not finite or empty.
Expected<Grid> makeGrid(const GridOptions& options, const Bounds& bounds);

/// makeGrid over the bounds of what is to be lit, with kFitMarginCells free cells on each side. Empty or degenerate
/// bounds give a grid around a 1 m box.
Expected<Grid> fitGrid(const GridOptions& options, const Bounds& content);

}  // namespace lpv
