#pragma once
// Plain elements made easy for zstd: differences to a base, then to the neighbour, byte by byte.

#include <cstddef>
#include <string>
#include <vector>

#include "wire/volume_state.h"

namespace lpv::wire {

/// One brick's part of planes.
struct PlaneBrick {
  glm::ivec3 size{0};               ///< cells
  const Brick* base = nullptr;      ///< null: zeros
  const std::string* from = nullptr;  ///< elements of all layers, to pack
  std::string* to = nullptr;          ///< room for them, to unpack
};

/// All elements of the bricks as byte planes (result.proto, VolumePart.payload), and back. Sizes must fit: a plane
/// has one byte per cell, layer and kind of element.
std::string planesFrom(const VolumeShape& shape, const std::vector<PlaneBrick>& bricks);
void elementsFromPlanes(const VolumeShape& shape, const std::string& planes, const std::vector<PlaneBrick>& bricks);

}  // namespace lpv::wire
