#include "wire/bricks.h"

namespace lpv::wire {
namespace {

glm::ivec3 brickDims(const glm::ivec3& dims) { return (dims + (kBrickEdge - 1)) / kBrickEdge; }

}  // namespace

int brickCount(const glm::ivec3& dims) {
  const glm::ivec3 n = brickDims(dims);
  return n.x * n.y * n.z;
}

BrickBox brickBox(const glm::ivec3& dims, int brick) {
  const glm::ivec3 n = brickDims(dims);
  const glm::ivec3 first = glm::ivec3(brick % n.x, brick / n.x % n.y, brick / (n.x * n.y)) * kBrickEdge;
  return {first, glm::min(first + kBrickEdge, dims)};
}

std::vector<bool> bricksWithin(const Grid& grid, const Bounds& region) {
  const int bricks = brickCount(grid.dims);
  const glm::dvec3 low = grid.gridFromWorld(region.min) - 0.5;
  const glm::dvec3 high = grid.gridFromWorld(region.max) + 0.5;
  std::vector<bool> out(std::size_t(bricks), false);
  for (int brick = 0; brick < bricks; ++brick) {
    const BrickBox box = brickBox(grid.dims, brick);
    out[std::size_t(brick)] =
        glm::all(glm::lessThan(glm::dvec3(box.first), high)) && glm::all(glm::greaterThan(glm::dvec3(box.end), low));
  }
  return out;
}

}  // namespace lpv::wire
