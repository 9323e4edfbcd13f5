#pragma once
// A coverage grid: which share of each cell's cross-sections along x, y and z triangles cover. Light may be marched
// through it instead of asking triangles; visibility_bench compares the two ways.
//
// Shares are counted on kCoverageLines^2 lines along each axis through every cell: a line is covered where a triangle
// cuts it within the cell. So two sheets behind one another in a cell cover what one does, and triangles that share an
// edge leave no gap.

#include <array>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "scene/grid.h"
#include "scene/occluders.h"

namespace lpv::bench {

inline constexpr int kCoverageLines = 16;  ///< across a cell, along each of the two other axes

/// Which lines a cell's triangles cut: per axis kCoverageLines rows, a bit per line. Of axis x rows lie along z and
/// bits along y; of y along x and z; of z along y and x.
struct CoveredLines {
  std::array<std::array<std::uint16_t, kCoverageLines>, 3> rows{};

  CoveredLines& operator|=(const CoveredLines& other);
  glm::u8vec3 shares() const;  ///< 255: all lines of the axis
};

/// Cells [lower, upper).
struct CellBox {
  glm::ivec3 lower{0}, upper{0};

  glm::ivec3 size() const { return glm::max(upper - lower, glm::ivec3(0)); }
  std::size_t cells() const { return std::size_t(size().x) * std::size_t(size().y) * std::size_t(size().z); }
  bool holds(const glm::ivec3& c) const {
    return glm::all(glm::greaterThanEqual(c, lower)) && glm::all(glm::lessThan(c, upper));
  }
};
CellBox around(const CellBox& a, const CellBox& b);

/// What one mesh covers. Immutable.
class MeshCoverage {
 public:
  MeshCoverage(const Mesh& mesh, const glm::dmat4& gridFromObject, const glm::ivec3& dims);

  const CellBox& box() const { return box_; }
  const std::vector<glm::ivec3>& cells() const { return cells_; }  ///< with lines that are cut
  /// Null where nothing is cut.
  const CoveredLines* at(const glm::ivec3& cell) const;
  std::size_t bytes() const;

 private:
  void addTriangle(const std::array<glm::dvec3, 3>& corners);
  void addAlong(int axis, const std::array<glm::dvec3, 3>& corners);
  void mark(int axis, const glm::ivec3& cell, int row, std::uint16_t bits);
  std::size_t indexOf(const glm::ivec3& cell) const;

  glm::ivec3 dims_;
  CellBox box_;
  std::vector<std::int32_t> slots_;  ///< per cell of the box: which of lines_, or -1
  std::vector<glm::ivec3> cells_;
  std::vector<CoveredLines> lines_;
};

/// The coverage of all occluders, each kept apart, so that one that moves costs what it covers, before and after.
class CoverageGrid {
 public:
  /// `dims` cells over the bounds that `gridFromWorld` leads from. All occluders count as opaque.
  CoverageGrid(const std::vector<Occluder>& occluders, const glm::dmat4& gridFromWorld, const glm::ivec3& dims);
  /// At twice the resolution of a volume's grid.
  CoverageGrid(const std::vector<Occluder>& occluders, const Grid& volume);

  /// Puts occluder `index` to where it is now; the cells that may have changed.
  CellBox move(std::size_t index, const Occluder& moved);

  const glm::ivec3& dims() const { return dims_; }
  /// 255: closed along the axis; w is 0. In the memory order of Grid.
  const std::vector<glm::u8vec4>& shares() const { return shares_; }
  glm::u8vec4 at(const glm::ivec3& cell) const { return shares_[indexOf(cell)]; }
  /// What the occluders' lines take, which moves need.
  std::size_t lineBytes() const;

 private:
  std::size_t indexOf(const glm::ivec3& c) const;
  void merge(const MeshCoverage& where);

  glm::dmat4 gridFromWorld_;
  glm::ivec3 dims_;
  std::vector<MeshCoverage> meshes_;
  std::vector<glm::u8vec4> shares_;
};

}  // namespace lpv::bench
