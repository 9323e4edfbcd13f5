#pragma once

#include <string>

#include "base/status.h"
#include "renderer/traced_scene.h"

namespace lpv::evaluation {

/// Writes what was read of a scene file, in world space, so that another renderer gets the same scene: scene.json,
/// which lists the objects and says where their arrays begin in scene.bin (little-endian; float64 positions, normals
/// and uvs, uint32 triangles), and texture-N.exr, linear, rows from v = 0. The folder must be there.
Status dumpScene(const TracedScene& scene, const std::string& folder);

}  // namespace lpv::evaluation
