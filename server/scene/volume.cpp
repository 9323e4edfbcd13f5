#include "scene/volume.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace lpv {
namespace {

using ColourCoefficients = std::array<sh::Coefficients, 3>;

ColourCoefficients cellAt(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell) {
  return {Volume::at(layer, grid, cell, 0), Volume::at(layer, grid, cell, 1), Volume::at(layer, grid, cell, 2)};
}

/// Trilinear between cell centres, clamped to the outermost ones. `g` in grid space.
ColourCoefficients trilinear(const VolumeLayer& layer, const Grid& grid, const glm::dvec3& g) {
  const glm::dvec3 top(grid.dims - 1);
  const glm::dvec3 centred = glm::clamp(g - 0.5, glm::dvec3(0.0), top);
  const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(centred)), glm::max(grid.dims - 2, glm::ivec3(0)));
  const glm::dvec3 f = centred - glm::dvec3(low);
  ColourCoefficients sum{};
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 axis = glm::mix(1.0 - f, f, glm::dvec3(offset));
    const double weight = axis.x * axis.y * axis.z;
    if (weight == 0.0) continue;
    const ColourCoefficients cell = cellAt(layer, grid, glm::min(low + offset, grid.dims - 1));
    for (int colour = 0; colour < 3; ++colour) sum[std::size_t(colour)] += weight * cell[std::size_t(colour)];
  }
  return sum;
}

}  // namespace

sh::Coefficients Volume::at(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell, int colour) {
  const float* c = &layer.coefficients[(grid.index(cell) * 3 + std::size_t(colour)) * 4];
  return {c[0], c[1], c[2], c[3]};
}

double irradianceSh2(const sh::Coefficients& incident, const glm::dvec3& n) {
  return std::max(0.0, sh::fluence(incident) / 4.0 + glm::dot(sh::vectorIrradiance(incident), n) / 2.0);
}

Irradiance irradianceAt(const Volume& volume, Lookup lookup, const glm::dvec3& p, const glm::dvec3& n) {
  Irradiance out;
  const glm::dvec3 g = volume.grid.gridFromWorld(p);
  const glm::dvec3 far(volume.grid.dims);
  out.valid = glm::all(glm::greaterThanEqual(g, glm::dvec3(-0.5))) && glm::all(glm::lessThanEqual(g, far + 0.5));
  if (!out.valid) return out;
  const glm::ivec3 nearest = glm::clamp(glm::ivec3(glm::floor(g)), glm::ivec3(0), volume.grid.dims - 1);
  for (const VolumeLayer& layer : volume.layers) {
    const ColourCoefficients c =
        lookup == Lookup::kNearest ? cellAt(layer, volume.grid, nearest) : trilinear(layer, volume.grid, g);
    for (int colour = 0; colour < 3; ++colour) out.rgb[colour] += irradianceSh2(c[std::size_t(colour)], n);
  }
  return out;
}

}  // namespace lpv
