#pragma once
// HALF_FLOAT and FLOAT elements rearranged so that zstd compresses them well: differences to the base, then to the
// neighbouring cell, split into byte planes.

#include <cstddef>
#include <string>
#include <vector>

#include "wire/volume_state.h"

namespace lpv::wire {

/// One brick to pack into byte planes or to unpack from them.
struct PlaneBrick {
  glm::ivec3 size{0};               ///< cells
  const Brick* base = nullptr;      ///< null: zeros
  const std::string* from = nullptr;  ///< packing: elements of all layers
  std::string* to = nullptr;          ///< unpacking: where they go; already of their size
};

/// Packs all elements of the bricks into byte planes (result.proto, VolumePart.payload), and unpacks them. A plane has
/// one byte per cell and layer; there is one for each of the 12 elements of a cell and each byte of an element. The
/// caller has checked the sizes.
std::string planesFrom(const VolumeShape& shape, const std::vector<PlaneBrick>& bricks);
void elementsFromPlanes(const VolumeShape& shape, const std::string& planes, const std::vector<PlaneBrick>& bricks);

}  // namespace lpv::wire
