#pragma once
// Which lights share a volume. One lookup takes all light of a group at a point for one cap (MATHS.md 4): lights on two
// sides of a receiver want a group each, lights on one side do not.

#include <string>
#include <vector>

#include "lpv/resources/lights.h"

namespace lpv {

/// Whether groups are chosen where the scene names none: quality ACCURATE or an error goal, transport GATHER, lookup
/// CAP.
bool groupsItself(const LightingSettings& options);

/// Puts each light into a group by what the scene says: by hand, where any light names a group; by itself, where
/// groupsItself; else into one. Sets `group` of each light and returns the groups' names in order: one at least.
/// By itself: the fewest groups, up to kMaxGroups, whose lookups differ from a lookup per light by no more than
/// groupingGoal (scene/error_goal.h); `previous`, the groups of the same lights in the last tick, stand while they are
/// within twice that, so that lights that move do not change groups all the time.
std::vector<std::string> groupLights(const Scene& scene, std::vector<EmittingLight>& lights,
                                     const std::vector<int>& previous);

/// The error of a grouping, group per light, by that measure: lights stand in as spheres of their size that emit as
/// their area and normals say.
double groupingError(const std::vector<EmittingLight>& lights, const Grid& grid, const std::vector<int>& groups);

}  // namespace lpv
