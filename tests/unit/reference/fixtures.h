#pragma once
// What several of the reference's own tests begin with.

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "scene/grid.h"

namespace lpv::reference {

/// Around the origin, one cell more along y and one fewer along z than along x. `edge` of a cell: metres.
inline Grid gridOf(int cells, double edge) {
  Grid grid;
  grid.cell = edge;
  grid.dims = {cells, cells + 1, cells - 1};
  grid.origin = -0.5 * edge * glm::dvec3(grid.dims);
  return grid;
}

/// The 48 matrices that permute the axes and flip any of them.
inline std::vector<glm::dmat3> symmetries() {
  std::vector<glm::dmat3> all;
  for (const auto& [x, y, z] : {std::array<int, 3>{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}}) {
    for (int signs = 0; signs < 8; ++signs) {
      glm::dmat3 m(0.0);
      m[0][x] = signs & 1 ? -1.0 : 1.0;
      m[1][y] = signs & 2 ? -1.0 : 1.0;
      m[2][z] = signs & 4 ? -1.0 : 1.0;
      all.push_back(m);
    }
  }
  return all;
}

}  // namespace lpv::reference
