#pragma once
// Where irradiance is compared with the truth, and by which measures (MATHS.md 5, metrics).

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

#include "reference/emitter.h"
#include "reference/field.h"
#include "scene/grid.h"
#include "scene/options.h"

namespace lpv::reference {

struct Receiver {
  glm::dvec3 position{0.0};  ///< world
  glm::dvec3 normal{0.0};    ///< unit
};

/// The walls of an empty room within the grid: at .1 and .9 of its edges, normals inwards, 12 x 12 points each in the
/// middles of as many rectangles: 864.
std::vector<Receiver> wallReceivers(const Grid& grid);

/// Random points of that room with random normals, at least two cells away from every emitter.
std::vector<Receiver> objectReceivers(const Grid& grid, const std::vector<Emitter>& emitters, std::size_t count,
                                      std::uint32_t seed = 1);

/// From a point to the nearest point of a triangle.
double distanceToTriangle(const glm::dvec3& p, const std::array<glm::dvec3, 3>& corners);

/// Irradiance per receiver: the truth, and what a field says (0 where it says nothing).
std::vector<glm::dvec3> irradiances(const std::vector<Emitter>& emitters, const std::vector<Receiver>& receivers);
std::vector<glm::dvec3> irradiances(const Grid& grid, const Field& field, Lookup how,
                                    const std::vector<Receiver>& receivers);

/// Of a (under test) against b (the truth), over all receivers and colours.
struct Errors {
  double raw = 0.0;    ///< ||a - b|| / ||b||
  double shape = 0.0;  ///< the same after a has been scaled by the one factor that brings it closest to b
  double worst = 0.0;  ///< largest |a - b| as a share of the largest b
  double logRatio95 = 0.0;  ///< 95th percentile of |ln(a / b)| of sums over the colours, both at least 1 % of b's mean
  double logRatio99 = 0.0;  ///< its 99th
};
Errors errors(const std::vector<glm::dvec3>& a, const std::vector<glm::dvec3>& b);

}  // namespace lpv::reference
