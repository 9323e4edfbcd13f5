#pragma once
// Reads scene files as lights, surfaces and cameras.

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
  bool keepVertices = false;            ///< keep the file's vertex order; equal vertices are not merged
  bool ignoreEmissiveTextures = false;  ///< a light emits its texture's mean colour instead
};

/// A file's content in world space. Objects share meshes and textures as in the file.
struct ImportedScene {
  std::vector<Light> lights;        ///< objects with an emissive material
  std::vector<Surface> surfaces;    ///< the others
  std::vector<std::pair<std::string, Camera>> cameras;
  std::vector<std::string> warnings;  ///< sentences about what was ignored
  std::vector<std::string> assumed;   ///< sentences about what light that passes surfaces was taken to do
};

/// Reads glb, gltf, obj, ply or stl, by extension. One light or surface per node and material, named after the node. A
/// matrix with shear, which a Transform cannot hold, is baked into the vertices. Radiance of emissive materials: glTF
/// emissiveFactor x KHR_materials_emissive_strength x texture, OBJ Ke, taken 1:1 as W/(sr m^2). Files without normals
/// are shaded flat, as glTF and OBJ demand; PLY scans get smooth ones. INVALID_ARGUMENT if the file cannot be read, is
/// cut short, or has no triangle.
Expected<ImportedScene> importScene(const std::string& path, const ImportOptions& options);

/// All triangles of a file as one mesh, in the file's space scaled and turned as `options` say.
Expected<Mesh> importMesh(const std::string& path, const ImportOptions& options);

/// World bounds of everything imported.
Bounds boundsOf(const ImportedScene& scene);

}  // namespace lpv::cli
