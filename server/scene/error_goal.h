#pragma once
// Expected error of settings, from a table of measurements, and the cheapest settings that reach a wanted error.
// What is expected of a scene is predicted from it (scene/predicted_error.h); the table is for what cannot be.
//
// Error: raw relative L2 of irradiance on the walls of a room without occluders against the closed form for polygons.
// The lights are a quarter as long as the room; the table has the worst of the paper's five meshes over several poses
// (tests/bench/ACCURACY.md; tests/gpu/transport/gather_accuracy_test.cpp measures it again). It excludes receivers near
// emitters, receivers whose horizon cuts a light, and textures whose texels differ in colour, for which the error is up
// to twice as large (a VPL has one position for all colours).

#include "scene/options.h"

namespace lpv {

/// Expected error of resolved settings on a grid with `longestCells` cells along its longest edge. Several lights in
/// one group add up to kGroupingError, or what the error goal leaves.
double expectedError(const LightingSettings& options, int longestCells);

/// Resolves what settings leave to the server, at the least cost that reaches the error goal by the table: AUTO as
/// GATHER (scene/transport_choice.h knows better where there is a scene), k where it
/// is 0, and the cells where no size is given (kDefaultCellsOfLongestEdge without a goal, and no fewer unless the grid
/// is automatic). Sessions get their cells from the scene (scene/grid_choice.h). Other fields are copied.
LightingSettings resolved(const LightingSettings& options);

/// What merging voxels into VPLs and nodes adds with this opening ratio, where the volume is looked up.
double mergingError(double openingRatio);

/// The grid of a session with these settings, before anything of its scene is looked at: over its bounds, or fitted to
/// `content` (makeGrid, fitGrid).
Expected<Grid> gridFor(const LightingSettings& options, const Bounds& content);

/// INVALID_ARGUMENT if the settings do not reach their error goal. The message has the errors expected of them and of
/// the best settings.
Status checkErrorGoal(const LightingSettings& options);

/// Largest error that automatic grouping may add by sharing groups: kGroupingError, or what the error goal
/// leaves.
double groupingGoal(const LightingSettings& options, int longestCells);

/// Error by the measure of MATHS.md 4.4.
inline constexpr double kGroupingError = 0.01;

}  // namespace lpv
