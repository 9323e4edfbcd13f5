#pragma once
// What error settings are expected to give, from measurements, and settings that reach a wanted one.
//
// Raw relative L2 of irradiance on the walls of a room without occluders against the closed form for polygons, of
// lights a quarter as long as the room: the worst of the paper's five meshes over several poses
// (tests/bench/ACCURACY.md; tests/gpu/transport/gather_accuracy_test.cpp measures the table again). Receivers near
// emitters, and normals towards whose horizon a light reaches, are not in it; nor are textures whose texels differ in
// colour, which are up to twice as far off (a VPL has one place for all colours).

#include "scene/options.h"

namespace lpv {

/// Of settings as they are carried out, on a grid of so many cells along its longest edge; several lights in one group
/// add up to kGroupingError or the goal's.
double expectedError(const LightingSettings& options, int longestCells);

/// Settings with what an error goal leaves to the server chosen: k where it is 0, and with an automatic grid its cells
/// (kDefaultCellsOfLongestEdge without a goal), so that the goal is reached at the least cost. Others as they are.
LightingSettings resolved(const LightingSettings& options);

/// The grid of a session with those settings: over its bounds, or fitted to `content` (makeGrid, fitGrid).
Expected<Grid> gridFor(const LightingSettings& options, const Bounds& content);

/// INVALID_ARGUMENT for an error goal that the settings do not reach: what they, and what the best of their transport,
/// are expected to give.
Status checkErrorGoal(const LightingSettings& options);

/// How much lights that share a group may add to the error where the server groups them: kGroupingError, or what the
/// goal leaves.
double groupingGoal(const LightingSettings& options, int longestCells);

/// Relative L2 of irradiance over points of the grid and the six axis normals.
inline constexpr double kGroupingError = 0.01;

}  // namespace lpv
