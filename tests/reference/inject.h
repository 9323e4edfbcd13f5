#pragma once
// Injection in double: what every cell emits, as SH of intensity (W/sr, direction of emission); MATHS.md 2.

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/emission.h"
#include "reference/emitter.h"
#include "reference/field.h"
#include "scene/grid.h"

namespace lpv::reference {

/// COUNT: the mean of radiance x lobe over a cell's VPLs (paper eq. 1, i = 1..N), times one cell face s^2.
struct Counted {
  Field intensity;
  std::vector<std::uint32_t> lobes;  ///< N of each cell; a two-sided triangle counts twice

  explicit Counted(const Grid& grid) : intensity(grid.dims), lobes(grid.cells()) {}
  /// One lobe of `radiance` about unit `direction`, and its opposite for two sides; sums, until divided.
  void add(const glm::ivec3& cell, const glm::dvec3& radiance, const glm::dvec3& direction, bool twoSided);
  /// Once, after the last lobe: times cellEdge^2 / N.
  void divide(double cellEdge);
};

/// The lobes of vpls.h for every pair: one about the normal where a triangle is homogeneous.
Counted injectCount(const Grid& grid, const std::vector<Emitter>& emitters);

/// A triangle clipped to one cell: what it carries into it.
struct FluxPair {
  std::size_t emitter = 0;         ///< index into the list given
  glm::ivec3 cell{0};
  double fraction = 0.0;           ///< share of the triangle's area, from the snapped triangle
  double area = 0.0;               ///< m^2: fraction of the unsnapped area
  glm::dvec3 areaNormal{0.0};      ///< area x unit normal
  glm::dvec3 areaCentroid{0.0};    ///< area x centroid, world metres, on the unsnapped triangle
  glm::dvec3 areaRadiance{0.0};    ///< radiance x texture integrated over the part, W/sr
  Glow glow;                       ///< where it emits from
  DirectedEmission directed;       ///< the direction, alone and times radiance x texture, integrated over the part
};

/// FLUX: every pair with its clipped part, by emitter, then by cell in memory order.
std::vector<FluxPair> fluxPairs(const Grid& grid, const std::vector<Emitter>& emitters);

/// Sum of radiance x lobe(direction) integrated over each pair's part; a two-sided triangle adds the opposite too.
Field injectFlux(const Grid& grid, const std::vector<Emitter>& emitters);

/// Emitted power of a field of intensity, W per colour: pi (sum of L00) / c0, for lobes of any mix.
glm::dvec3 injectedPower(const Field& intensity);

}  // namespace lpv::reference
