#pragma once
// A light for scene files that have none.

#include "import/scene_file.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace lpv::cli {

/// A square "key" beside the camera, to the left of it and above, as far as nothing is in the way, that faces what the
/// camera looks at and sends it an irradiance of pi W/m^2.
Light keyLight(const Scene& scene, const Camera& camera);

/// The surfaces of a file as a scene.
Scene sceneOf(const ImportedScene& file);

}  // namespace lpv::cli
