#pragma once
// Bricks: blocks of 8^3 cells, each coded on its own. Bricks at the grid's upper borders hold fewer cells.

#include <cstddef>
#include <glm/glm.hpp>
#include <vector>

#include "scene/bounds.h"
#include "scene/grid.h"

namespace lpv::wire {

/// Edge of a brick, cells.
inline constexpr int kBrickEdge = 8;

/// Consecutive bricks. Bricks are numbered x fastest over ceil(dims / 8).
struct BrickRun {
  int first = 0;
  int count = 0;
};

/// Half-open range of cells of one brick: [first, end).
struct BrickBox {
  glm::ivec3 first{0};
  glm::ivec3 end{0};

  glm::ivec3 size() const { return end - first; }
  std::size_t cells() const { return std::size_t(size().x) * std::size_t(size().y) * std::size_t(size().z); }
};

/// Number of bricks of a grid.
int brickCount(const glm::ivec3& dims);
BrickBox brickBox(const glm::ivec3& dims, int brick);

/// True for each brick with a cell that lookups inside `region` (world, metres) read: the bricks that intersect the
/// region enlarged by half a cell on each side. A region outside the grid selects no brick.
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
