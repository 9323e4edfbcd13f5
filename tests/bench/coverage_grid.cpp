#include "coverage_grid.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <utility>

namespace lpv::bench {

namespace {

constexpr int kLines = kCoverageLines;
constexpr std::uint16_t kAllBits = 0xffff;
static_assert(kLines == 16, "a row is 16 bits");

/// Bits `first` to `last`.
std::uint16_t bitsOf(int first, int last) {
  return std::uint16_t((kAllBits << first) & (kAllBits >> (kLines - 1 - last)));
}

/// A triangle as lines along an axis see it: across in lines, along in cells.
struct SeenAlong {
  std::array<glm::dvec2, 3> across;
  double nearest = 0.0, farthest = 0.0;
  double first = 0.0;  ///< along, of the first corner
  glm::dvec2 slope{0.0};  ///< of along, by lines across
  bool edgeOn = false;

  double along(const glm::dvec2& p) const {
    return std::clamp(first + glm::dot(slope, p - across[0]), nearest, farthest);
  }
};

SeenAlong seenAlong(int axis, const std::array<glm::dvec3, 3>& corners) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  SeenAlong out;
  std::array<double, 3> along{};
  for (std::size_t i = 0; i < 3; ++i) {
    out.across[i] = double(kLines) * glm::dvec2(corners[i][u], corners[i][v]);
    along[i] = corners[i][axis];
  }
  out.nearest = std::ranges::min(along);
  out.farthest = std::ranges::max(along);
  out.first = along[0];
  const glm::dvec2 a = out.across[1] - out.across[0], b = out.across[2] - out.across[0];
  const double da = along[1] - along[0], db = along[2] - along[0], area = a.x * b.y - a.y * b.x;
  out.edgeOn = area == 0.0;
  if (!out.edgeOn) out.slope = glm::dvec2(da * b.y - db * a.y, db * a.x - da * b.x) / area;
  return out;
}

/// First and last line in between, both included; none where last < first.
std::pair<int, int> linesBetween(double from, double to, int first, int last) {
  return {int(std::max(std::ceil(from - 0.5), double(first))), int(std::min(std::floor(to - 0.5), double(last)))};
}

/// Where a row of lines at `y` enters and leaves a triangle. The same for both triangles that share an edge, to the
/// last bit: ends are taken in one order.
std::pair<double, double> spanAt(const std::array<glm::dvec2, 3>& c, double y) {
  double from = 1e300, to = -1e300;
  for (std::size_t i = 0; i < 3; ++i) {
    glm::dvec2 p = c[i], q = c[(i + 1) % 3];
    if (q.y < p.y || (q.y == p.y && q.x < p.x)) std::swap(p, q);
    if (p.y == q.y || y < p.y || y > q.y) continue;
    const double x = p.x + (y - p.y) / (q.y - p.y) * (q.x - p.x);
    from = std::min(from, x);
    to = std::max(to, x);
  }
  return {from, to};
}

}  // namespace

CoveredLines& CoveredLines::operator|=(const CoveredLines& other) {
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t i = 0; i < rows[axis].size(); ++i) rows[axis][i] |= other.rows[axis][i];
  return *this;
}

glm::u8vec3 CoveredLines::shares() const {
  glm::u8vec3 out;
  for (int axis = 0; axis < 3; ++axis) {
    int cut = 0;
    for (const std::uint16_t row : rows[std::size_t(axis)]) cut += std::popcount(row);
    out[axis] = std::uint8_t((255 * cut + kLines * kLines / 2) / (kLines * kLines));
  }
  return out;
}

CellBox around(const CellBox& a, const CellBox& b) {
  if (a.cells() == 0 || b.cells() == 0) return a.cells() == 0 ? b : a;
  return {glm::min(a.lower, b.lower), glm::max(a.upper, b.upper)};
}

MeshCoverage::MeshCoverage(const Mesh& mesh, const glm::dmat4& gridFromObject, const glm::ivec3& dims) : dims_(dims) {
  std::vector<glm::dvec3> corners;
  glm::dvec3 low(1e300), high(-1e300);
  for (const glm::vec3& p : mesh.positions) {
    corners.emplace_back(gridFromObject * glm::dvec4(glm::dvec3(p), 1.0));
    low = glm::min(low, corners.back());
    high = glm::max(high, corners.back());
  }
  const glm::dvec3 end(dims);
  box_.lower = glm::min(glm::ivec3(glm::floor(glm::clamp(low, glm::dvec3(0.0), end))), dims - 1);
  box_.upper = glm::min(glm::ivec3(glm::floor(glm::clamp(high, glm::dvec3(0.0), end))) + 1, dims);
  slots_.assign(box_.cells(), -1);
  for (const glm::uvec3& t : mesh.triangles) addTriangle({corners[t.x], corners[t.y], corners[t.z]});
}

void MeshCoverage::addTriangle(const std::array<glm::dvec3, 3>& corners) {
  for (int axis = 0; axis < 3; ++axis) addAlong(axis, corners);
}

void MeshCoverage::addAlong(int axis, const std::array<glm::dvec3, 3>& corners) {
  const SeenAlong seen = seenAlong(axis, corners);
  if (seen.edgeOn) return;
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  const auto [low, high] = std::minmax({seen.across[0].y, seen.across[1].y, seen.across[2].y});
  const auto [firstRow, lastRow] = linesBetween(low, high, kLines * box_.lower[v], kLines * box_.upper[v] - 1);
  // The grid's outer upper face belongs to the last cell.
  const auto layerOf = [&](double along) { return int(std::floor(along)) - int(along == double(dims_[axis])); };
  for (int row = firstRow; row <= lastRow; ++row) {
    const auto [from, to] = spanAt(seen.across, row + 0.5);
    const auto [first, last] = linesBetween(from, to, kLines * box_.lower[u], kLines * box_.upper[u] - 1);
    for (int line = first; line <= last;) {
      glm::ivec3 cell(0);
      cell[u] = line / kLines;
      cell[v] = row / kLines;
      const int begin = kLines * cell[u];
      int end = std::min(begin + kLines - 1, last);
      cell[axis] = layerOf(seen.along({line + 0.5, row + 0.5}));
      // Depth is linear: where both ends lie in one layer, all of the run does.
      while (layerOf(seen.along({end + 0.5, row + 0.5})) != cell[axis]) end = (line + end) / 2;
      mark(axis, cell, row % kLines, bitsOf(line - begin, end - begin));
      line = end + 1;
    }
  }
}

std::size_t MeshCoverage::indexOf(const glm::ivec3& cell) const {
  const glm::ivec3 c = cell - box_.lower, n = box_.size();
  return (std::size_t(c.z) * std::size_t(n.y) + std::size_t(c.y)) * std::size_t(n.x) + std::size_t(c.x);
}

void MeshCoverage::mark(int axis, const glm::ivec3& cell, int row, std::uint16_t bits) {
  if (!box_.holds(cell)) return;
  std::int32_t& slot = slots_[indexOf(cell)];
  if (slot < 0) {
    slot = std::int32_t(lines_.size());
    lines_.emplace_back();
    cells_.push_back(cell);
  }
  lines_[std::size_t(slot)].rows[std::size_t(axis)][std::size_t(row)] |= bits;
}

const CoveredLines* MeshCoverage::at(const glm::ivec3& cell) const {
  if (!box_.holds(cell)) return nullptr;
  const std::int32_t slot = slots_[indexOf(cell)];
  return slot < 0 ? nullptr : &lines_[std::size_t(slot)];
}

std::size_t MeshCoverage::bytes() const {
  return slots_.size() * sizeof slots_[0] + cells_.size() * sizeof cells_[0] + lines_.size() * sizeof lines_[0];
}

CoverageGrid::CoverageGrid(const std::vector<Occluder>& occluders, const glm::dmat4& gridFromWorld,
                           const glm::ivec3& dims)
    : gridFromWorld_(gridFromWorld),
      dims_(dims),
      shares_(std::size_t(dims.x) * std::size_t(dims.y) * std::size_t(dims.z)) {
  for (const Occluder& o : occluders) meshes_.emplace_back(*o.mesh, gridFromWorld_ * o.worldFromObject, dims_);
  for (const MeshCoverage& mesh : meshes_) merge(mesh);
}

CoverageGrid::CoverageGrid(const std::vector<Occluder>& occluders, const Grid& volume)
    : CoverageGrid(occluders, glm::scale(glm::dmat4(1.0), glm::dvec3(2.0)) * volume.gridFromWorldMatrix(),
                   2 * volume.dims) {}

std::size_t CoverageGrid::indexOf(const glm::ivec3& c) const {
  return (std::size_t(c.z) * std::size_t(dims_.y) + std::size_t(c.y)) * std::size_t(dims_.x) + std::size_t(c.x);
}

/// Counts anew what is covered in the cells that `where` has lines in.
void CoverageGrid::merge(const MeshCoverage& where) {
  std::vector<const MeshCoverage*> near;
  for (const MeshCoverage& mesh : meshes_) {
    const CellBox common = {glm::max(mesh.box().lower, where.box().lower),
                            glm::min(mesh.box().upper, where.box().upper)};
    if (common.cells() != 0) near.push_back(&mesh);
  }
  for (const glm::ivec3& cell : where.cells()) {
    CoveredLines all;
    for (const MeshCoverage* mesh : near) {
      if (const CoveredLines* lines = mesh->at(cell)) all |= *lines;
    }
    shares_[indexOf(cell)] = glm::u8vec4(all.shares(), 0);
  }
}

CellBox CoverageGrid::move(std::size_t index, const Occluder& moved) {
  const MeshCoverage before =
      std::exchange(meshes_[index], MeshCoverage(*moved.mesh, gridFromWorld_ * moved.worldFromObject, dims_));
  merge(before);
  merge(meshes_[index]);
  return around(before.box(), meshes_[index].box());
}

std::size_t CoverageGrid::lineBytes() const {
  std::size_t sum = 0;
  for (const MeshCoverage& mesh : meshes_) sum += mesh.bytes();
  return sum;
}

}  // namespace lpv::bench
