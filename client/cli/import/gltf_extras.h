#pragma once
// Properties of a glTF file that Assimp 5.2 drops or reports unreliably: emissive strengths, cameras' fields of view.

#include <glm/glm.hpp>
#include <map>
#include <string>
#include <vector>

#include "import/gltf_json.h"

namespace lpv::cli {

/// A material with an emissive factor.
struct EmissiveMaterial {
  std::string name;
  glm::dvec3 factor{0.0};
  double strength = 1.0;  ///< KHR_materials_emissive_strength
};

struct GltfExtras {
  std::vector<EmissiveMaterial> emissive;
  std::map<std::string, double> verticalFov;  ///< radians, by the name of the camera's node

  /// Strength of the material with this name and factor; 1 if there is none. Importers renumber materials, so name and
  /// factor together identify one.
  double strengthOf(const std::string& name, const glm::dvec3& factor) const;
};

GltfExtras readGltfExtras(const JsonPlace& root);

}  // namespace lpv::cli
