#pragma once
// Whether anything in a scene can stand between a light and what it lights (MATHS.md 3d).

#include "scene/scene.h"

namespace lpv {

/// Whether frames, probes and volumes of the scene have shadows: as its settings say, and with AUTO where
/// shadowsPossible, or where haze takes light on its way. PROPAGATE has none.
bool isShadowed(const Scene& scene);

/// False where no shadow can be: every surface has all lights and surfaces on one side of each of its planes, as the
/// walls of an empty room have, and every light is flat or convex. May be true without need, where there are many
/// planes to look at. Follows from geometry alone.
bool shadowsPossible(const Scene& scene);

/// Whether lights, which reflect nothing, are in the way of much of what surfaces reflect: where their area is more
/// than a hundredth of the surfaces', or one shines at a surface that is nearer than a quarter of its own size.
bool lightsSwallow(const Scene& scene);

/// Whether something may stand in the way of what surfaces reflect: where isShadowed, and with AUTO where
/// lightsSwallow.
bool reflectionsBlocked(const Scene& scene);

/// Whether a mesh has itself on one side of each of its triangles' planes: no ray between two of its points meets it in
/// between. False where that would take long to find out.
bool isConvex(const Mesh& mesh);

/// Whether a light may stand in the way of its own light.
bool blocksItself(const Light& light);

}  // namespace lpv
