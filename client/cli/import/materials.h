#pragma once
// Converts Assimp's materials to radiance or albedo, with their textures.

#include <assimp/material.h>
#include <assimp/scene.h>

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "import/gltf_extras.h"
#include "import/image.h"
#include "import/scene_file.h"
#include "scene/texture.h"

namespace lpv::cli {

/// The properties of a material that a light or a surface can use.
struct Material {
  glm::dvec3 radiance{0.0};  ///< W/(sr m^2); 0: the material does not emit
  glm::dvec3 albedo{0.8};
  double roughness = 1.0;
  double metalness = 0.0;
  TexturePtr gloss;  ///< of a surface: its green multiplies the roughness, its blue the metalness
  bool doubleSided = false;
  bool oneSidedSurface = false;  ///< the file says that back faces are not drawn
  AlphaMode alphaMode = AlphaMode::kOpaque;
  double alphaCutoff = 0.5;
  double opacity = 1.0;
  glm::dvec3 transmission{1.0};  ///< of a surface, as scene.h has it
  bool textureAlpha = false;     ///< that of the texture counts
  bool tints = false;            ///< its texture colours what passes, where that has no alpha
  std::string passes;            ///< what was assumed about light that passes, in words; empty: nothing
  TexturePtr texture;            ///< multiplies the radiance of an emitter, else the albedo
  unsigned uvChannel = 0;        ///< the textures' uv channel
  TexturePtr normals;            ///< of a surface, tangent-space
  double normalScale = 1.0;

  bool emits() const { return radiance.x > 0.0 || radiance.y > 0.0 || radiance.z > 0.0; }
};

/// Reads the materials of one file. Each texture is read once; one that cannot be read is ignored with a warning.
class Materials {
 public:
  Materials(const aiScene& scene, const std::string& path, const GltfExtras& extras, const ImportOptions& options);
  const Material& at(unsigned index) { return materials_[index]; }
  std::vector<std::string> takeWarnings() { return std::move(warnings_); }

 private:
  Material read(const aiMaterial& material);
  void readAlpha(const aiMaterial& material, Material& out) const;
  void readNormals(const aiMaterial& material, Material& out);
  void readGloss(const aiMaterial& material, Material& out);
  TexturePtr numbers(const aiMaterial& material, aiTextureType type, const std::string& what, Material& out);
  void setTexture(const aiMaterial& material, const std::vector<aiTextureType>& types, Material& out);
  TexturePtr texture(const std::string& name, ImageUse use);
  Expected<Texture> load(const std::string& name, ImageUse use) const;

  const aiScene& scene_;
  std::string folder_;
  std::string extension_;
  const GltfExtras& extras_;
  ImportOptions options_;
  std::map<std::pair<std::string, ImageUse>, TexturePtr> textures_;
  std::vector<Material> materials_;
  std::vector<std::string> warnings_;
};

}  // namespace lpv::cli
