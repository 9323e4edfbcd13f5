#include "reference/polygon.h"

namespace lpv::reference {

Polygon wholeTriangle() { return {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}; }

double coordinate(const SnappedTriangle& t, const glm::dvec3& b, int axis, std::int64_t origin) {
  return b.x * double(t.corners[0][axis] - origin) + b.y * double(t.corners[1][axis] - origin) +
         b.z * double(t.corners[2][axis] - origin);
}

Polygon clipToSlab(const Polygon& in, const SnappedTriangle& t, int axis, int cell) {
  const std::int64_t low = std::int64_t(cell) * kUnitsPerCell;
  const Polygon above = clip(in, [&](const glm::dvec3& b) { return coordinate(t, b, axis, low); });
  return clip(above, [&](const glm::dvec3& b) { return -coordinate(t, b, axis, low + kUnitsPerCell); });
}

Polygon partInCell(const SnappedTriangle& t, const glm::ivec3& cell) {
  Polygon part = wholeTriangle();
  for (int axis = 0; axis < 3; ++axis) part = clipToSlab(part, t, axis, cell[axis]);
  return part;
}

double fractionOf(const std::array<glm::dvec3, 3>& corners) {
  const glm::dvec3 u = corners[1] - corners[0];
  const glm::dvec3 v = corners[2] - corners[0];
  return u.y * v.z - u.z * v.y;
}

std::vector<std::array<glm::dvec3, 3>> fanOf(const Polygon& polygon) {
  std::vector<std::array<glm::dvec3, 3>> fan;
  for (std::size_t i = 2; i < polygon.size(); ++i) fan.push_back({polygon[0], polygon[i - 1], polygon[i]});
  return fan;
}

Share measure(const Polygon& polygon) {
  double area = 0.0;
  glm::dvec3 moment(0.0);
  for (const auto& piece : fanOf(polygon)) {
    area += fractionOf(piece);
    moment += fractionOf(piece) * (piece[0] + piece[1] + piece[2]) / 3.0;
  }
  return area != 0.0 ? Share{area, moment / area} : Share{};
}

}  // namespace lpv::reference
