#pragma once
// What the reference computes on: 4 SH coefficients for each of 3 colours in every cell, in double.

#include <array>
#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

namespace lpv::reference {

/// (L00, L1-1, L10, L11): the order of MATHS.md 1.
using Coefficients = glm::dvec4;

/// cells x 3 colours x 4 coefficients, cells x fastest, then y, then z: the memory order of lpv::VolumeLayer.
struct Field {
  glm::ivec3 dims{0};
  std::vector<std::array<Coefficients, 3>> cells;

  Field() = default;
  explicit Field(const glm::ivec3& d)
      : dims(d), cells(std::size_t(d.x) * std::size_t(d.y) * std::size_t(d.z), {Coefficients(0), {}, {}}) {}

  bool contains(const glm::ivec3& c) const {
    return c.x >= 0 && c.y >= 0 && c.z >= 0 && c.x < dims.x && c.y < dims.y && c.z < dims.z;
  }
  std::size_t index(const glm::ivec3& c) const {
    return (std::size_t(c.z) * std::size_t(dims.y) + std::size_t(c.y)) * std::size_t(dims.x) + std::size_t(c.x);
  }
  std::array<Coefficients, 3>& at(const glm::ivec3& c) { return cells[index(c)]; }
  const std::array<Coefficients, 3>& at(const glm::ivec3& c) const { return cells[index(c)]; }
};

/// Calls visit(cell) for every cell in memory order.
template <typename Visit>
void forEachCell(const glm::ivec3& dims, Visit visit) {
  for (int z = 0; z < dims.z; ++z)
    for (int y = 0; y < dims.y; ++y)
      for (int x = 0; x < dims.x; ++x) visit(glm::ivec3(x, y, z));
}

}  // namespace lpv::reference
