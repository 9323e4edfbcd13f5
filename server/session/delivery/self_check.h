#pragma once
// How far a session's light is from the truth, measured while it runs.

#include <cstdint>
#include <optional>

#include "scene/scene.h"
#include "scene/volume.h"
#include "session/delivery/error_estimate.h"

namespace lpv {

/// Receivers of one check at most; fewer where lights have so many triangles that it would take long.
inline constexpr int kCheckedReceivers = 256;

/// Raw relative L2 of irradiance over the scene's surfaces, as its frames look it up, against the closed form for
/// polygons (Lambert; Arvo 1995), of light that nothing stands in the way of and that comes from lights alone. Half of
/// the points lie uniformly on the surfaces, half where light falls: at what rays from the lights cross, so that their
/// density follows the irradiance. Both are weighted by the area that they stand for (balance heuristic; Veach & Guibas
/// 1995). Without surfaces: over the walls of a room a tenth smaller than the grid. Null where there is no such truth
/// or nobody to see it: textures, emission directions, no light, lights of more than kMostCheckedTriangles triangles.
/// `seed` chooses the points. Takes up to some tenths of a second: not for threads that must not wait.
std::optional<ErrorEstimate> selfCheck(const Scene& scene, const Volume& volume, std::uint32_t seed);

/// Whether there is such a truth.
bool canSelfCheck(const Scene& scene);

inline constexpr std::size_t kMostCheckedTriangles = 500'000;

}  // namespace lpv
