#pragma once
// A room to take pictures of: Cornell-like, with a lamp at the ceiling and two boxes, 34 surface triangles.

#include "scene/camera.h"
#include "scene/scene.h"

namespace lpv::reference {

/// 2 x 2 x 2 m about the origin, open towards +z: white floor, ceiling and back, red left, green right, two turned
/// boxes, a one-sided lamp of .8 x .8 m just below the ceiling. Grid: longest^3 cells over
/// 2.25 m about the origin, so that 18 cells put the walls on cell faces.
Scene smallRoom(int longest = 18);

/// Looks into the room from the open side.
Camera roomCamera();

}  // namespace lpv::reference
