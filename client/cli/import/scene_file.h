#pragma once
// Scene files on this machine to lights, surfaces and cameras.

#include <string>
#include <utility>
#include <vector>

#include "base/status.h"
#include "scene/bounds.h"
#include "scene/camera.h"
#include "scene/scene.h"

namespace lpv::cli {

struct ImportOptions {
  double scale = 1.0;                   ///< metres per unit of the file
  bool zUp = false;                     ///< the file's +Z is up, its +Y points away
  bool keepVertices = false;            ///< as the file numbers them, equal ones not joined
  bool ignoreEmissiveTextures = false;  ///< a light emits its texture's mean colour instead
};

/// A file's content in world space. Meshes and textures shared within the file are shared here.
struct ImportedScene {
  std::vector<Light> lights;        ///< objects whose material emits
  std::vector<Surface> surfaces;    ///< the others
  std::vector<std::pair<std::string, Camera>> cameras;
  std::vector<std::string> warnings;  ///< what could not be taken over, for people
};

/// glb, gltf, obj, ply or stl, by extension. One light or surface per node and material, named after the node; a
/// transform that a Transform cannot hold (shear) is baked into the vertices. Emissive: glTF emissiveFactor x
/// KHR_materials_emissive_strength x texture, OBJ Ke; taken 1:1 as radiance. Files without normals are shaded flat, as
/// glTF and OBJ want it; PLY scans smooth. INVALID_ARGUMENT for files that cannot be read, are cut short, or hold no
/// triangle.
Expected<ImportedScene> importScene(const std::string& path, const ImportOptions& options);

/// All triangles of a file as one mesh, in the file's own space scaled and turned as `options` say.
Expected<Mesh> importMesh(const std::string& path, const ImportOptions& options);

/// World bounds of everything imported.
Bounds boundsOf(const ImportedScene& scene);

}  // namespace lpv::cli
