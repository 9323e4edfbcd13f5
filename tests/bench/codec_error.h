#pragma once

#include "scene/volume.h"

namespace lpv::bench {

/// What a coding adds to the error of the light.
struct AddedError {
  double irradiance = 0.0;  ///< relative L2 of irradiance (lookup CAP) over all cells, colours and the six axis normals
  double cell = 0.0;  ///< largest such difference of a cell and colour, relative to its own fluence ...
  double fluence = 0.0;  ///< ... and largest difference of fluence, likewise; cells above 1e-5 of the largest
};

AddedError addedError(const Volume& truth, const Volume& held);

}  // namespace lpv::bench
