#include "reference/pairs.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>

#include "reference/field.h"
#include "reference/int128.h"

namespace lpv::reference {
namespace {

// With |v| <= 2^19: edges 2^20, normals 2^41, products with v 3 * 2^60: 64 bits hold. Beyond, 128 bits to 2^40.
constexpr std::int64_t kMaxLatticeOf64Bits = std::int64_t(1) << 19;

template <typename Int>
using Vec = std::array<Int, 3>;

template <typename Int>
Vec<Int> cross(const Vec<Int>& a, const Vec<Int>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

template <typename Int>
Int dot(const Vec<Int>& a, const Vec<Int>& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/// One separating axis with the triangle's interval, and the box's interval relative to its minimum corner.
template <typename Int>
struct Axis {
  Vec<Int> direction;
  Int triangleMin, triangleMax;
  Int boxMin, boxMax;
};

/// A triangle's 13 axes; `layerAxis` >= 0 when it lies in the face plane `layer` of that axis.
template <typename Int>
class SeparatingAxes {
 public:
  SeparatingAxes(const SnappedTriangle& triangle, int layerAxis) : layerAxis_(layerAxis) {
    for (std::size_t i = 0; i < 3; ++i) {
      for (int k = 0; k < 3; ++k) corners_[i][std::size_t(k)] = Int(triangle.corners[i][k]);
    }
    std::array<Vec<Int>, 3> edges;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) edges[i][k] = corners_[(i + 1) % 3][k] - corners_[i][k];
    }
    for (std::size_t k = 0; k < 3; ++k) {
      Vec<Int> unit{};
      unit[k] = 1;
      add(unit);
      for (const Vec<Int>& edge : edges) add(cross(unit, edge));
    }
    add(cross(edges[0], edges[1]));
  }

  bool overlapStrictly(const glm::ivec3& cell) const {
    const Vec<Int> corner = {Int(cell.x) * kUnitsPerCell, Int(cell.y) * kUnitsPerCell, Int(cell.z) * kUnitsPerCell};
    return std::all_of(axes_.begin(), axes_.begin() + count_, [&](const Axis<Int>& axis) {
      const Int base = dot(axis.direction, corner);
      return axis.triangleMax > base + axis.boxMin && axis.triangleMin < base + axis.boxMax;
    });
  }

 private:
  /// Zero axes say nothing. For a triangle in a face plane, neither does that plane's own axis.
  void add(const Vec<Int>& direction) {
    bool useful = false;
    for (int k = 0; k < 3; ++k) useful = useful || (k != layerAxis_ && direction[std::size_t(k)] != 0);
    if (!useful) return;
    Axis<Int> axis{direction, dot(direction, corners_[0]), dot(direction, corners_[0]), 0, 0};
    for (const Vec<Int>& corner : corners_) {
      axis.triangleMin = std::min(axis.triangleMin, dot(direction, corner));
      axis.triangleMax = std::max(axis.triangleMax, dot(direction, corner));
    }
    for (const Int d : direction) (d > 0 ? axis.boxMax : axis.boxMin) += d * kUnitsPerCell;
    axes_[count_++] = axis;
  }

  int layerAxis_;
  std::array<Vec<Int>, 3> corners_;
  std::array<Axis<Int>, 13> axes_;
  std::size_t count_ = 0;
};

std::int64_t floorDivide(std::int64_t a, std::int64_t b) { return a / b - (a % b != 0 && (a < 0) != (b < 0) ? 1 : 0); }

std::int64_t largestCoordinate(const SnappedTriangle& t) {
  std::int64_t largest = 0;
  for (const LatticePoint& p : t.corners) {
    for (int k = 0; k < 3; ++k) largest = std::max({largest, p[k], -p[k]});
  }
  return largest;
}

/// The axis of a face plane that holds the whole triangle, and the layer of cells it belongs to.
struct FacePlane {
  int axis;
  std::int64_t layer;
};

std::optional<FacePlane> facePlane(const SnappedTriangle& t, const glm::ivec3& dims) {
  for (int k = 0; k < 3; ++k) {
    const std::int64_t x = t.corners[0][k];
    if (x != t.corners[1][k] || x != t.corners[2][k] || x % kUnitsPerCell != 0) continue;
    const std::int64_t layer = x / kUnitsPerCell;
    return FacePlane{k, layer == dims[k] ? layer - 1 : layer};
  }
  return std::nullopt;
}

/// Candidate cells: the triangle's box and one more on each side, within the grid.
std::pair<glm::ivec3, glm::ivec3> candidates(const SnappedTriangle& t, const glm::ivec3& dims) {
  glm::ivec3 lower(0);
  glm::ivec3 upper(0);
  for (int k = 0; k < 3; ++k) {
    const auto [least, most] = std::minmax({t.corners[0][k], t.corners[1][k], t.corners[2][k]});
    lower[k] = int(std::clamp<std::int64_t>(floorDivide(least, kUnitsPerCell) - 1, 0, dims[k]));
    upper[k] = int(std::clamp<std::int64_t>(floorDivide(most, kUnitsPerCell) + 1, -1, dims[k] - 1));
  }
  return {lower, upper};
}

/// The cell of a coordinate that all corners share: [i, i + 1), and the last one's upper face.
std::int64_t halfOpenCell(std::int64_t x, int cells) {
  return x == std::int64_t(kUnitsPerCell) * cells ? cells - 1 : floorDivide(x, kUnitsPerCell);
}

/// n / d, d > 0.
struct Ratio {
  Int128 n, d;
  bool operator<(const Ratio& other) const { return n * other.d < other.n * d; }
};

Ratio ratio(Int128 n, Int128 d) { return d < 0 ? Ratio{-n, -d} : Ratio{n, d}; }

/// The two corners that are farthest apart along the axis of the longest extent: all others lie between them.
std::array<LatticePoint, 2> endsOf(const SnappedTriangle& t) {
  std::array<LatticePoint, 2> ends = {t.corners[0], t.corners[0]};
  std::int64_t longest = 0;
  for (int k = 0; k < 3; ++k) {
    for (const LatticePoint& p : t.corners) {
      for (const LatticePoint& q : t.corners) {
        if (q[k] - p[k] <= longest) continue;
        longest = q[k] - p[k];
        ends = {p, q};
      }
    }
  }
  return ends;
}

/// Whether p + s (q - p) is within the cell for an interval of s in (0, 1) that has a length; for a point, whether it
/// is in the cell.
bool passes(const std::array<LatticePoint, 2>& ends, const glm::ivec3& cell, const glm::ivec3& dims) {
  Ratio from = {0, 1};
  Ratio to = {1, 1};
  for (int k = 0; k < 3; ++k) {
    const std::int64_t p = ends[0][k];
    const std::int64_t d = ends[1][k] - p;
    if (d == 0) {
      if (cell[k] != halfOpenCell(p, dims[k])) return false;
      continue;
    }
    const Ratio low = ratio(std::int64_t(cell[k]) * kUnitsPerCell - p, d);
    const Ratio high = ratio((std::int64_t(cell[k]) + 1) * kUnitsPerCell - p, d);
    from = std::max(from, std::min(low, high));
    to = std::min(to, std::max(low, high));
  }
  return from < to;
}

std::vector<glm::ivec3> cellsOfSegment(const SnappedTriangle& t, const glm::ivec3& dims) {
  const std::array<LatticePoint, 2> ends = endsOf(t);
  const auto [lower, upper] = candidates(t, dims);
  std::vector<glm::ivec3> cells;
  for (int z = lower.z; z <= upper.z; ++z)
    for (int y = lower.y; y <= upper.y; ++y)
      for (int x = lower.x; x <= upper.x; ++x) {
        if (passes(ends, {x, y, z}, dims)) cells.emplace_back(x, y, z);
      }
  return cells;
}

template <typename Int>
std::vector<glm::ivec3> cellsWith(const SnappedTriangle& t, const glm::ivec3& dims) {
  const std::optional<FacePlane> plane = facePlane(t, dims);
  const SeparatingAxes<Int> axes(t, plane ? plane->axis : -1);
  const auto [lower, upper] = candidates(t, dims);
  std::vector<glm::ivec3> cells;
  for (int z = lower.z; z <= upper.z; ++z)
    for (int y = lower.y; y <= upper.y; ++y)
      for (int x = lower.x; x <= upper.x; ++x) {
        const glm::ivec3 cell(x, y, z);
        if (plane && cell[plane->axis] != plane->layer) continue;
        if (axes.overlapStrictly(cell)) cells.push_back(cell);
      }
  return cells;
}

}  // namespace

bool isDegenerate(const SnappedTriangle& t) {
  Vec<Int128> a{};
  Vec<Int128> b{};
  for (int k = 0; k < 3; ++k) {
    a[std::size_t(k)] = t.corners[1][k] - t.corners[0][k];
    b[std::size_t(k)] = t.corners[2][k] - t.corners[0][k];
  }
  return cross(a, b) == Vec<Int128>{};
}

bool isPair(const SnappedTriangle& triangle, const glm::ivec3& cell, const glm::ivec3& dims) {
  const std::vector<glm::ivec3> cells = cellsOf(triangle, dims);
  return std::find(cells.begin(), cells.end(), cell) != cells.end();
}

std::vector<glm::ivec3> cellsOf(const SnappedTriangle& triangle, const glm::ivec3& dims) {
  const std::int64_t largest = largestCoordinate(triangle);
  if (largest > kMaxLattice) throw std::out_of_range("lattice coordinate beyond the oracle's range");
  if (isDegenerate(triangle)) return cellsOfSegment(triangle, dims);
  return largest <= kMaxLatticeOf64Bits ? cellsWith<std::int64_t>(triangle, dims) : cellsWith<Int128>(triangle, dims);
}

std::vector<Pair> pairsOf(const std::vector<SnappedTriangle>& triangles, const glm::ivec3& dims) {
  std::vector<Pair> pairs;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    for (const glm::ivec3& cell : cellsOf(triangles[i], dims)) pairs.push_back({i, cell});
  }
  return pairs;
}

}  // namespace lpv::reference
