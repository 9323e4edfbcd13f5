#pragma once
// A camera for a scene that brings none.

#include "import/scene_file.h"
#include "scene/camera.h"

namespace lpv::cli {

/// Inside a closed room: from near one end along its longest horizontal axis, at half its height, where the view is
/// widest. A room with one open side: through that side, from outside. Anything else: scene/camera.h's defaultCamera.
/// `aspect`: width / height of the picture.
Camera defaultView(const ImportedScene& scene, double aspect);

}  // namespace lpv::cli
