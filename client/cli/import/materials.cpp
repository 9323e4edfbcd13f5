#include "import/materials.h"

#include <assimp/GltfMaterial.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <utility>

#include "import/file_check.h"
#include "import/gltf_data.h"
#include "import/image.h"

namespace lpv::cli {
namespace {

constexpr double kLargestRadiance = 1e9;
/// Of AI_MATKEY_GLTF_PBRMETALLICROUGHNESS_METALLICROUGHNESS_TEXTURE.
constexpr aiTextureType kBothInOne = aiTextureType_UNKNOWN;

double factor(const aiMaterial& material, const char* key, unsigned type, unsigned index, double otherwise) {
  ai_real value = 0;
  return material.Get(key, type, index, value) == AI_SUCCESS && std::isfinite(value) ? double(value) : otherwise;
}

std::optional<glm::dvec3> colour(const aiMaterial& material, const char* key, unsigned type, unsigned index) {
  aiColor4D value;
  if (material.Get(key, type, index, value) != AI_SUCCESS) return {};
  const glm::dvec3 rgb(value.r, value.g, value.b);
  if (!std::isfinite(rgb.x) || !std::isfinite(rgb.y) || !std::isfinite(rgb.z)) return {};
  return glm::max(rgb, glm::dvec3(0.0));
}

std::string nameOf(const aiMaterial& material) {
  aiString name;
  return material.Get(AI_MATKEY_NAME, name) == AI_SUCCESS ? std::string(name.C_Str()) : std::string();
}

AlphaMode modeOf(const std::string& gltf) {
  return gltf == "MASK" ? AlphaMode::kMask : gltf == "BLEND" ? AlphaMode::kBlend : AlphaMode::kOpaque;
}

/// A picture of the first channels of two of one size, either of which may be missing: green and blue.
TexturePtr glossOf(const TexturePtr& roughness, const TexturePtr& metalness) {
  const TexturePtr& any = roughness ? roughness : metalness;
  if (!any) return nullptr;
  Texture out;
  out.width = any->width;
  out.height = any->height;
  out.format = TexelFormat::kRgb8;
  const auto byteOf = [](float value) {
    return std::uint8_t(std::lround(255.0 * std::clamp(double(value), 0.0, 1.0)));
  };
  std::vector<glm::vec3> green, blue;
  for (int y = 0; y < out.height; ++y) {
    green.assign(roughness ? 0 : std::size_t(out.width), glm::vec3(1.0F));
    blue.assign(metalness ? 0 : std::size_t(out.width), glm::vec3(1.0F));
    if (roughness) appendLinearRow(*roughness, y, green);
    if (metalness) appendLinearRow(*metalness, y, blue);
    for (std::size_t x = 0; x < green.size(); ++x)
      out.texels.insert(out.texels.end(), {std::uint8_t(255), byteOf(green[x].x), byteOf(blue[x].x)});
  }
  return std::make_shared<const Texture>(std::move(out));
}

std::string percent(double share) { return std::to_string(std::lround(100.0 * share)) + " %"; }

/// "glass: lets 90 % of light through, unrefracted".
std::string assumedOf(const std::string& name, const Material& m) {
  const std::string what = (name.empty() ? "a material without name" : name) + ": ";
  const bool varies = m.texture != nullptr && hasAlpha(*m.texture);
  if (m.alphaMode == AlphaMode::kMask) {
    const bool nothing = m.opacity < m.alphaCutoff;
    if (!varies && !nothing) return "";
    return what + (nothing ? "all of it is cut out" : "cut out where alpha is below " + percent(m.alphaCutoff));
  }
  if (m.alphaMode == AlphaMode::kOpaque) return "";
  const glm::dvec3 through = (1.0 - m.opacity) * m.transmission;
  if (through == glm::dvec3(0.0) && !varies) return "";
  std::string share = percent(through.x);
  if (through.x != through.y || through.y != through.z)
    share += ", " + percent(through.y) + ", " + percent(through.z) + " (red, green, blue)";
  return what + "lets " + share + " of light through" + (varies ? ", more where its texture does" : "") +
         ", unrefracted";
}

}  // namespace

Materials::Materials(const aiScene& scene, const std::string& path, const GltfExtras& extras,
                     const ImportOptions& options)
    : scene_(scene),
      folder_(std::filesystem::path(path).parent_path().string()),
      extension_(extensionOf(path)),
      extras_(extras),
      options_(options) {
  for (unsigned i = 0; i < scene.mNumMaterials; ++i) materials_.push_back(read(*scene.mMaterials[i]));
}

Material Materials::read(const aiMaterial& material) {
  Material out;
  if (extension_ == "ply" || extension_ == "stl")
    return out;  // these files have no materials; the importer invents one
  const glm::dvec3 emissive = colour(material, AI_MATKEY_COLOR_EMISSIVE).value_or(glm::dvec3(0.0));
  out.radiance = emissive * extras_.strengthOf(nameOf(material), emissive);
  out.radiance = glm::clamp(out.radiance, 0.0, kLargestRadiance);
  const auto base = colour(material, AI_MATKEY_BASE_COLOR);
  out.albedo = base ? *base : colour(material, AI_MATKEY_COLOR_DIFFUSE).value_or(out.albedo);
  out.albedo = glm::clamp(out.albedo, 0.0, 1.0);
  out.roughness = std::clamp(factor(material, AI_MATKEY_ROUGHNESS_FACTOR, 1.0), 0.0, 1.0);
  out.metalness = std::clamp(factor(material, AI_MATKEY_METALLIC_FACTOR, 0.0), 0.0, 1.0);
  int twoSided = 0;
  out.doubleSided = material.Get(AI_MATKEY_TWOSIDED, twoSided) == AI_SUCCESS && twoSided != 0;
  out.oneSidedSurface = (extension_ == "glb" || extension_ == "gltf") && !out.doubleSided;
  if (out.emits()) {
    setTexture(material, {aiTextureType_EMISSIVE, aiTextureType_EMISSION_COLOR}, out);
    if (out.texture && options_.ignoreEmissiveTextures) {
      out.radiance *= meanColour(*out.texture);
      out.texture = nullptr;
    }
  } else {
    readAlpha(material, out);
    if (material.GetTextureCount(aiTextureType_OPACITY) > 0)
      warnings_.push_back("ignored the opacity texture of " + nameOf(material) +
                          ": put its values into the alpha of the colour's texture");
    setTexture(material, {aiTextureType_BASE_COLOR, aiTextureType_DIFFUSE}, out);
    readNormals(material, out);
    readGloss(material, out);
    if (out.alphaMode == AlphaMode::kBlend && out.texture && !hasAlpha(*out.texture) && out.tints)
      out.transmission *= glm::min(meanColour(*out.texture), glm::dvec3(1.0));
    out.passes = assumedOf(nameOf(material), out);
  }
  return out;
}

/// glTF: alpha of the base colour, and KHR_materials_transmission, which takes (1 - its factor) off what is covered;
/// OBJ: d or Tr, and Tf. The base colour is what glass of glTF lets through.
void Materials::readAlpha(const aiMaterial& material, Material& out) const {
  aiString mode;
  const bool gltf = extension_ == "glb" || extension_ == "gltf";
  if (gltf && material.Get(AI_MATKEY_GLTF_ALPHAMODE, mode) == AI_SUCCESS) out.alphaMode = modeOf(mode.C_Str());
  out.textureAlpha = out.alphaMode != AlphaMode::kOpaque;
  out.alphaCutoff = std::clamp(factor(material, AI_MATKEY_GLTF_ALPHACUTOFF, 0.5), 0.0, 1.0);
  const double opacity = std::clamp(factor(material, AI_MATKEY_OPACITY, 1.0), 0.0, 1.0);
  if (!gltf) {
    if (opacity == 1.0) return;
    out.alphaMode = AlphaMode::kBlend;
    out.opacity = opacity;
    out.transmission =
        glm::min(colour(material, AI_MATKEY_COLOR_TRANSPARENT).value_or(out.transmission), glm::dvec3(1));
    return;
  }
  if (out.alphaMode != AlphaMode::kOpaque) out.opacity = opacity;
  if (out.alphaMode == AlphaMode::kBlend) out.transmission = out.albedo;
  const double transmits = std::clamp(factor(material, AI_MATKEY_TRANSMISSION_FACTOR, 0.0), 0.0, 1.0);
  out.tints = out.alphaMode == AlphaMode::kBlend || transmits > 0.0;
  if (transmits == 0.0 || out.alphaMode == AlphaMode::kMask) return;
  out.alphaMode = AlphaMode::kBlend;
  out.opacity *= 1.0 - transmits;
  out.transmission = out.albedo;
}

/// A texture that is no colour, or null. A mesh has one set of uvs here.
TexturePtr Materials::numbers(const aiMaterial& material, aiTextureType type, const std::string& what, Material& out) {
  aiString name;
  unsigned channel = 0;
  if (material.GetTexture(type, 0, &name, nullptr, &channel) != AI_SUCCESS || name.length == 0) return nullptr;
  if ((out.texture != nullptr || out.normals != nullptr) && channel != out.uvChannel) {
    warnings_.push_back("ignored the " + what + " texture of " + nameOf(material) +
                        ": it has other texture coordinates than its other textures; give all the same");
    return nullptr;
  }
  out.uvChannel = channel;
  return texture(name.C_Str(), ImageUse::kNumbers);
}

/// glTF's normalTexture, OBJ's norm.
void Materials::readNormals(const aiMaterial& material, Material& out) {
  out.normals = numbers(material, aiTextureType_NORMALS, "normal", out);
  out.normalScale =
      std::clamp(factor(material, AI_MATKEY_GLTF_TEXTURE_SCALE(aiTextureType_NORMALS, 0), 1.0), 0.0, 16.0);
}

/// glTF's metallicRoughnessTexture, which has both; OBJ's map_Pr and map_Pm, which are alone.
void Materials::readGloss(const aiMaterial& material, Material& out) {
  if (extension_ == "glb" || extension_ == "gltf") {
    out.gloss = numbers(material, kBothInOne, "roughness", out);
    return;
  }
  const TexturePtr roughness = numbers(material, aiTextureType_DIFFUSE_ROUGHNESS, "roughness", out);
  const TexturePtr metalness = numbers(material, aiTextureType_METALNESS, "metalness", out);
  if (metalness) out.metalness = std::clamp(factor(material, AI_MATKEY_METALLIC_FACTOR, 1.0), 0.0, 1.0);
  if (roughness && metalness && (roughness->width != metalness->width || roughness->height != metalness->height)) {
    warnings_.push_back("ignored the metalness texture of " + nameOf(material) +
                        ": it is not as large as that of the roughness; give both the same size");
    out.gloss = glossOf(roughness, nullptr);
    return;
  }
  out.gloss = glossOf(roughness, metalness);
}

/// The first of the texture types that the material has.
void Materials::setTexture(const aiMaterial& material, const std::vector<aiTextureType>& types, Material& out) {
  for (const aiTextureType type : types) {
    aiString name;
    unsigned channel = 0;
    if (material.GetTexture(type, 0, &name, nullptr, &channel) != AI_SUCCESS || name.length == 0) continue;
    out.texture = texture(name.C_Str(), out.textureAlpha ? ImageUse::kColourWithAlpha : ImageUse::kColour);
    out.uvChannel = channel;
    return;
  }
}

TexturePtr Materials::texture(const std::string& name, ImageUse use) {
  const auto known = textures_.find({name, use});
  if (known != textures_.end()) return known->second;
  Expected<Texture> loaded = load(name, use);
  if (!loaded) warnings_.push_back("ignored texture " + loaded.status().message());
  TexturePtr result = loaded ? std::make_shared<const Texture>(std::move(*loaded)) : nullptr;
  return textures_[{name, use}] = result;
}

Expected<Texture> Materials::load(const std::string& name, ImageUse use) const {
  if (const aiTexture* embedded = scene_.GetEmbeddedTexture(name.c_str()); embedded != nullptr) {
    if (embedded->mHeight != 0) return invalid("texture", name + ": uncompressed embedded textures cannot be read");
    const std::string bytes(reinterpret_cast<const char*>(embedded->pcData), embedded->mWidth);
    const bool webp = bytes.compare(0, 4, "RIFF") == 0;  // Assimp keeps formats of three letters only
    return decodeImage(bytes, webp ? "webp" : embedded->achFormatHint, use);
  }
  std::string relative = percentDecoded(name);
  std::replace(relative.begin(), relative.end(), '\\', '/');
  const std::filesystem::path path = std::filesystem::path(folder_) / relative;
  std::error_code error;
  if (!std::filesystem::exists(path, error)) return invalid("texture", path.string() + ": the file does not exist");
  return readImage(path.string(), use);
}

}  // namespace lpv::cli
