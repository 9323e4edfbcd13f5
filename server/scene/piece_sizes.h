#pragma once
// Finer pieces of folds where lights are near (MATHS.md 3d.7): what a window sends to the reveal around it, and to its
// bars, changes from centimetre to centimetre.

#include <vector>

#include "scene/patches_near_lights.h"
#include "scene/scene.h"

namespace lpv {

/// Half as wide as lights before a triangle are far, the brightest ones and those that have a twentieth of their
/// radiance; where that is less than `largest`, m^2.
PieceSizes pieceSizesNear(const std::vector<LightInPoints>& lights, const Scene& scene, double largest);

}  // namespace lpv
