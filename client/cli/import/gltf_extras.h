#pragma once
// What a glTF file says and Assimp 5.2 does not, or not in a way to rely on: emissive strengths, cameras' angles.

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

namespace lpv::cli {

/// A material with an emissive factor.
struct EmissiveMaterial {
  std::string name;
  glm::dvec3 factor{0.0};
  double strength = 1.0;  ///< KHR_materials_emissive_strength
};

struct GltfExtras {
  std::vector<EmissiveMaterial> emissive;
  std::map<std::string, double> verticalFov;  ///< radians, of the camera at the node of that name

  /// Strength of the material of this name and factor (importers renumber materials, so both together identify it);
  /// 1 where there is none.
  double strengthOf(const std::string& name, const glm::dvec3& factor) const;
};

/// Empty for files that are neither .glb nor .gltf, or cannot be read.
GltfExtras readGltfExtras(const std::string& path);

}  // namespace lpv::cli
