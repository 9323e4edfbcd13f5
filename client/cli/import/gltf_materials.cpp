#include "import/gltf_materials.h"

#include <algorithm>
#include <optional>

namespace lpv::cli {
namespace {

using nlohmann::json;

void copyNumber(const JsonPlace& from, const char* key, json& to) {
  if (from.at(key).present()) to[key] = from.at(key).number(0.0);
}

class MaterialWriter {
 public:
  MaterialWriter(const JsonPlace& root, json& out, std::vector<std::string>& warnings)
      : root_(root), out_(out), warnings_(warnings) {}

  void addTextures() {
    const JsonPlace textures = root_.at("textures");
    out_["textures"] = json::array();
    for (std::size_t i = 0; i < textures.size(); ++i) {
      sources_.push_back(sourceOf(textures.at(i)));
      out_["textures"].push_back({{"source", sources_.back().value_or(0)}});
    }
  }

  void addMaterials() {
    const JsonPlace materials = root_.at("materials");
    out_["materials"] = json::array();
    for (std::size_t i = 0; i < materials.size(); ++i) out_["materials"].push_back(material(materials.at(i)));
  }

 private:
  /// The image of a texture: its PNG or JPEG, else its WebP.
  std::optional<std::size_t> sourceOf(const JsonPlace& texture) const {
    const std::size_t images = root_.at("images").size();
    const JsonPlace source = texture.at("source");
    if (source.present()) return source.index(images, "images");
    return texture.at("extensions").at("EXT_texture_webp").at("source").index(images, "images");
  }

  void copyTexture(const JsonPlace& from, const char* key, json& to) {
    const JsonPlace place = from.at(key);
    if (!place.present()) return;
    const auto index = place.at("index").index(sources_.size(), "textures");
    if (!index) return;
    if (!sources_[*index]) {
      warnings_.push_back("ignored " + place.name() +
                          ": its image is of a kind that cannot be read; convert it to PNG");
      return;
    }
    if (place.at("extensions").at("KHR_texture_transform").present()) {
      warnings_.push_back("ignored the KHR_texture_transform of " + place.name() + ": its texture lies as without it");
    }
    to[key] = {{"index", *index}, {"texCoord", place.at("texCoord").whole(0)}};
  }

  json material(const JsonPlace& place) {
    json out = json::object();
    if (place.at("name").present()) out["name"] = place.at("name").text();
    if (place.at("doubleSided").present()) out["doubleSided"] = place.at("doubleSided").flag();
    if (place.at("alphaMode").present()) out["alphaMode"] = place.at("alphaMode").text();
    copyNumber(place, "alphaCutoff", out);
    copyNumbers(place, "emissiveFactor", 3, out);
    copyTexture(place, "emissiveTexture", out);
    copyTexture(place, "normalTexture", out);
    if (out.contains("normalTexture")) copyNumber(place.at("normalTexture"), "scale", out["normalTexture"]);
    const JsonPlace pbr = place.at("pbrMetallicRoughness");
    if (pbr.present()) {
      json& to = out["pbrMetallicRoughness"] = json::object();
      copyNumbers(pbr, "baseColorFactor", 4, to);
      copyTexture(pbr, "baseColorTexture", to);
      copyNumber(pbr, "metallicFactor", to);
      copyNumber(pbr, "roughnessFactor", to);
      copyTexture(pbr, "metallicRoughnessTexture", to);
    }
    addSpecularGlossiness(place, out);
    addTransmission(place, out);
    return out;
  }

  void addSpecularGlossiness(const JsonPlace& material, json& out) {
    const JsonPlace place = material.at("extensions").at("KHR_materials_pbrSpecularGlossiness");
    if (!place.present()) return;
    json& to = out["extensions"]["KHR_materials_pbrSpecularGlossiness"] = json::object();
    copyNumbers(place, "diffuseFactor", 4, to);
    copyTexture(place, "diffuseTexture", to);
    use("KHR_materials_pbrSpecularGlossiness");
  }

  void addTransmission(const JsonPlace& material, json& out) {
    const JsonPlace place = material.at("extensions").at("KHR_materials_transmission");
    if (!place.present()) return;
    copyNumber(place, "transmissionFactor", out["extensions"]["KHR_materials_transmission"]);
    use("KHR_materials_transmission");
    if (!place.at("transmissionTexture").present()) return;
    warnings_.push_back("ignored " + place.at("transmissionTexture").name() + ": its factor holds all over");
  }

  void use(const char* extension) {
    json& used = out_["extensionsUsed"];
    if (!used.is_array()) used = json::array();
    if (std::find(used.begin(), used.end(), extension) == used.end()) used.push_back(extension);
  }

  const JsonPlace& root_;
  json& out_;
  std::vector<std::string>& warnings_;
  std::vector<std::optional<std::size_t>> sources_;
};

/// The kind of an image that does not say it.
std::string mimeTypeOf(std::string_view bytes) {
  return bytes.substr(1, 3) == "PNG" ? "image/png" : bytes.substr(8, 4) == "WEBP" ? "image/webp" : "image/jpeg";
}

json plainImage(const JsonPlace& image, const JsonPlace& root, GltfData& data, const AddView& addView) {
  const JsonPlace uri = image.at("uri");
  std::optional<std::string> inside = uri.present() ? dataFromUri(uri.text()) : std::nullopt;
  if (uri.present() && !inside) return {{"uri", uri.text()}};
  const auto view = image.at("bufferView").index(root.at("bufferViews").size(), "bufferViews");
  if (!inside && view) inside = std::string(data.view(*view));
  if (!inside || inside->empty()) return {{"uri", ""}};
  const JsonPlace type = image.at("mimeType");
  return {{"bufferView", addView(*inside)}, {"mimeType", type.present() ? type.text() : mimeTypeOf(*inside)}};
}

}  // namespace

void addPlainMaterials(const JsonPlace& root, GltfData& data, const AddView& addView, json& out,
                       std::vector<std::string>& warnings) {
  MaterialWriter writer(root, out, warnings);
  writer.addTextures();
  writer.addMaterials();
  const JsonPlace images = root.at("images");
  out["images"] = json::array();
  for (std::size_t i = 0; i < images.size(); ++i)
    out["images"].push_back(plainImage(images.at(i), root, data, addView));
}

}  // namespace lpv::cli
