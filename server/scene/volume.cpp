#include "scene/volume.h"

namespace lpv {

sh::Coefficients Volume::at(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell, int colour) {
  const float* c = &layer.coefficients[(grid.index(cell) * 3 + std::size_t(colour)) * 4];
  return {c[0], c[1], c[2], c[3]};
}

Grid guardedGrid(const Grid& grid) {
  Grid out = grid;
  out.origin -= double(kGuardCells) * grid.cell;
  out.dims += 2 * kGuardCells;
  return out;
}

}  // namespace lpv
