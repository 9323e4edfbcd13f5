#pragma once
// How far a session's volume is from the truth, measured while it runs.

#include <cstdint>
#include <optional>

#include "scene/scene.h"
#include "scene/volume.h"

namespace lpv {

/// Receivers of one check at most; fewer where lights have so many triangles that it would take long.
inline constexpr int kCheckedReceivers = 64;

/// Raw relative L2 of irradiance looked up in the volume against the closed form for polygons (Lambert; Arvo 1995), at
/// random points of the scene's surfaces within the grid, where there are none on the walls of the grid's room; without
/// those near emitters or in the dark. No occluders, as in the volume. Null where there is no such truth or nobody to
/// see it: textures, emission directions, no light, lights of more than kMostCheckedTriangles triangles.
/// `seed` chooses the points. Takes up to some tenths of a second: not for threads that must not wait.
std::optional<double> selfCheck(const Scene& scene, const Volume& volume, std::uint32_t seed);

/// Whether there is such a truth.
bool canSelfCheck(const Scene& scene);

inline constexpr std::size_t kMostCheckedTriangles = 500'000;

}  // namespace lpv
