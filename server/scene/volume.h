#pragma once
// Volumes: SH of incident radiance per cell.

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "scene/emitter_list.h"
#include "scene/grid.h"
#include "scene/sh.h"

namespace lpv {

/// Cells beyond the grid on each side that a lookup on its bounds reads.
inline constexpr int kGuardCells = 1;

/// Which field a volume shows.
enum class VolumeStage {
  kInjected,     ///< SH of emitted intensity per cell, W/sr, direction of emission (MATHS.md 2)
  kTransported,  ///< SH of incident radiance at cell centres, W/(sr m^2), direction towards the light
};

/// One light group's field: cells x 3 colours x 4 coefficients, x fastest: [((z ny + y) nx + x) 3 + colour] 4 + coef.
struct VolumeLayer {
  std::string group;
  std::vector<float> coefficients;
};

/// 1..8 layers over one grid. Irradiance is looked up per layer and summed.
struct Volume {
  Grid grid;
  VolumeStage stage = VolumeStage::kTransported;
  std::vector<VolumeLayer> layers;
  EmitterListPtr direct;  ///< its lights, for receivers near emitters or outside the grid; null with PROPAGATE
  bool probed = false;    ///< `direct` has what surfaces reflect, or nothing is reflected
  /// The same with kGuardCells more on each side, for lookups on the grid's bounds; null unless asked for. With
  /// PROPAGATE, which has no light beyond the grid, these are what lookups clamp to.
  std::shared_ptr<const Volume> guarded = nullptr;
  /// The same layers without what receivers with `direct` look at wherever they are; empty where that is nothing.
  std::vector<VolumeLayer> lookedUp = {};

  /// Coefficients of one cell and colour.
  static sh::Coefficients at(const VolumeLayer& layer, const Grid& grid, const glm::ivec3& cell, int colour);
};
/// `grid` with kGuardCells more on each side.
Grid guardedGrid(const Grid& grid);
using VolumePtr = std::shared_ptr<const Volume>;

}  // namespace lpv
