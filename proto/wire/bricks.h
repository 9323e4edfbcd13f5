#pragma once
// Bricks: the pieces of a volume that are coded by themselves, 8^3 cells, cut at the grid's upper borders.

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "scene/bounds.h"
#include "scene/grid.h"

namespace lpv::wire {

/// Edge of a brick, cells.
inline constexpr int kBrickEdge = 8;

/// Consecutive bricks; numbered x fastest over ceil(dims / 8).
struct BrickRun {
  int first = 0;
  int count = 0;
};

/// The cells of one brick: [first, end).
struct BrickBox {
  glm::ivec3 first{0};
  glm::ivec3 end{0};

  glm::ivec3 size() const { return end - first; }
  std::size_t cells() const { return std::size_t(size().x) * std::size_t(size().y) * std::size_t(size().z); }
};

/// Number of bricks of a grid.
int brickCount(const glm::ivec3& dims);
BrickBox brickBox(const glm::ivec3& dims, int brick);

/// True for the bricks with a cell that the lookup reads inside `region` (world, metres): those it meets, half a cell
/// wider on each side. A box beyond the grid chooses nothing.
std::vector<bool> bricksWithin(const Grid& grid, const Bounds& region);

/// Calls row(index of the first cell, number of cells) for each row of the brick, y then z.
template <typename Row>
void forEachRow(const Grid& grid, const BrickBox& box, const Row& row) {
  const auto cells = std::size_t(box.size().x);
  for (int z = box.first.z; z < box.end.z; ++z) {
    for (int y = box.first.y; y < box.end.y; ++y) row(grid.index({box.first.x, y, z}), cells);
  }
}

}  // namespace lpv::wire
