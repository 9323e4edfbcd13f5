#pragma once
// Layers by the direction that light comes from, for scenes with more lights than groups: each layer holds what comes
// to a cell from an eighth of all directions, whichever light sends it. The GLSL twin is
// shaders/transport/sectors.glsl.

#include <array>
#include <glm/glm.hpp>

#include "scene/scene.h"

namespace lpv {

/// How directions are told apart; LPV_SECTORS.
enum class Sectors { kNone, kOctants, kAroundX, kAroundY, kAroundZ };

inline constexpr int kSectors = kMaxGroups;

inline constexpr std::array kAllSectors = {Sectors::kOctants, Sectors::kAroundX, Sectors::kAroundY, Sectors::kAroundZ};

/// Per sector, the share of the light that comes from `towards`, of any length above 0. They sum to 1. `how` is not
/// kNone.
std::array<double, kSectors> sectorShares(Sectors how, const glm::dvec3& towards);

}  // namespace lpv
