#pragma once
// Which light shares a layer of the volume. One lookup takes all light of a layer at a point for one cap (MATHS.md 4):
// lights on two sides of a receiver want a layer each, lights on one side do not.

#include <string>
#include <vector>

#include "lpv/resources/lights.h"
#include "lpv/transport/sectors.h"

namespace lpv {

/// Layers in use.
struct Grouping {
  std::vector<int> groups;             ///< per light
  Sectors sectors = Sectors::kNone;    ///< layers by direction: all lights are in group 0
  std::vector<int> next = {};          ///< what `groups` are to become; empty: nothing
  double moved = 0.0;                  ///< share of each light that is there already

  bool operator==(const Grouping&) const = default;
};

/// Layers as the field has them.
struct Grouped {
  std::vector<std::string> names;      ///< in order: one at least
  Sectors sectors = Sectors::kNone;
};

/// Puts each light into a layer by what the scene says: by hand, where any light names a group; by itself, where
/// LightingSettings::groupsItself; else into one. Sets `group`,
/// `nextGroup` and `moved` of each light.
/// By itself: the fewest groups, up to kMaxGroups, whose lookups differ from a lookup per light by no more than
/// groupingGoal (scene/error_goal.h). Where no such groups are found, which more than kMostDealt lights are not looked
/// through for, layers are by direction, in the way that differs least. `previous`, the grouping of the same lights in
/// the last tick, gives way to finer groups bit by bit (Grouping::moved; MATHS.md 4.4); by direction it stands while it
/// differs by no more than half as much again as what is found. So nothing jumps where lights move.
Grouped groupLights(const Scene& scene, const CellBox& cells, std::vector<EmittingLight>& lights,
                    const Grouping& previous);

/// By so many lights the time is bounded.
inline constexpr std::size_t kMostDealt = 24;

/// The error of a grouping by that measure: lights stand in as spheres of their size that emit as their area and
/// normals say.
double groupingError(const std::vector<EmittingLight>& lights, const CellBox& cells, const Grouping& grouping);

}  // namespace lpv
