#pragma once
// What the codec bench sends: a living room's light as the engine makes it, result after result.

#include <vector>

#include "scene/volume.h"

namespace lpv::bench {

/// Volumes of the living room's windows (three by the sea side, one at the back) and a television whose screen shows
/// three colours and moves `cellsPerResult` cells to the side between two results: GATHER, 32^3 cells, one layer.
/// Runs on the first device.
std::vector<VolumePtr> movingTelevision(int results, double cellsPerResult);

}  // namespace lpv::bench
