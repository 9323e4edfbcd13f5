#include "import/gltf_meshes.h"

#include <algorithm>
#include <optional>
#include <utility>

#include "import/gltf_draco.h"

namespace lpv::cli {
namespace {

using nlohmann::json;

struct Semantic {
  const char* name;
  unsigned least;  ///< components
  unsigned most;
};

/// What Assimp reads of a vertex. Sets of texture coordinates and colours are numbered without gaps.
constexpr std::array<Semantic, 19> kSemantics{{{"POSITION", 3, 3},
                                               {"NORMAL", 3, 3},
                                               {"TANGENT", 4, 4},
                                               {"TEXCOORD_0", 2, 2},
                                               {"TEXCOORD_1", 2, 2},
                                               {"TEXCOORD_2", 2, 2},
                                               {"TEXCOORD_3", 2, 2},
                                               {"TEXCOORD_4", 2, 2},
                                               {"TEXCOORD_5", 2, 2},
                                               {"TEXCOORD_6", 2, 2},
                                               {"TEXCOORD_7", 2, 2},
                                               {"COLOR_0", 3, 4},
                                               {"COLOR_1", 3, 4},
                                               {"COLOR_2", 3, 4},
                                               {"COLOR_3", 3, 4},
                                               {"COLOR_4", 3, 4},
                                               {"COLOR_5", 3, 4},
                                               {"COLOR_6", 3, 4},
                                               {"COLOR_7", 3, 4}}};

/// The set before this one ("TEXCOORD_0" for "TEXCOORD_1"); empty for a first or only set.
std::string before(std::string name) {
  const bool numbered = name.find('_') != std::string::npos && name.back() > '0';
  if (!numbered) return {};
  --name.back();
  return name;
}

template <typename T>
std::string_view bytesOf(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

}  // namespace

GltfMeshWriter::GltfMeshWriter(const JsonPlace& root, GltfData& data, AddView addView, json& out,
                               std::vector<std::string>& warnings)
    : root_(root), data_(data), addView_(std::move(addView)), out_(out), warnings_(warnings) {}

void GltfMeshWriter::addMeshes() {
  const JsonPlace meshes = root_.at("meshes");
  out_["accessors"] = json::array();
  out_["meshes"] = json::array();
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    json mesh = {{"primitives", json::array()}};
    if (meshes.at(i).at("name").present()) mesh["name"] = meshes.at(i).at("name").text();
    const JsonPlace primitives = meshes.at(i).at("primitives");
    for (std::size_t k = 0; k < primitives.size(); ++k) {
      json out = primitive(primitives.at(k));
      if (!out.empty()) mesh["primitives"].push_back(std::move(out));
    }
    out_["meshes"].push_back(std::move(mesh));
  }
}

/// An empty value for a primitive without positions, which has nothing to show.
json GltfMeshWriter::primitive(const JsonPlace& place) {
  json out = json::object();
  const std::size_t mode = place.at("mode").whole(4);
  if (mode > 6) place.at("mode").refuse("is " + std::to_string(mode) + "; 0 to 6 are allowed");
  if (const auto material = place.at("material").index(root_.at("materials").size(), "materials")) {
    out["material"] = *material;
  }
  out["mode"] = mode;
  const JsonPlace draco = place.at("extensions").at("KHR_draco_mesh_compression");
  if (!draco.present() || !addDraco(place, draco, out)) addPlain(place, out);
  if (!out.contains("attributes")) return {};
  anyTriangle_ = anyTriangle_ || mode >= 4;
  return out;
}

void GltfMeshWriter::addPlain(const JsonPlace& place, json& out) {
  const Attributes attributes = readAttributes(place.at("attributes"));
  const auto positions = attributes.find("POSITION");
  if (positions == attributes.end()) return;
  addAttributes(place, attributes, out);
  if (!place.at("indices").present()) return;
  if (const Stored* indices = storedIndices(place.at("indices"))) {
    addIndices(place.at("indices"), *indices, positions->second.count, out);
  }
}

GltfMeshWriter::Attributes GltfMeshWriter::readAttributes(const JsonPlace& place) {
  Attributes out;
  for (const Semantic& semantic : kSemantics) {
    const JsonPlace index = place.at(semantic.name);
    const std::string former = before(semantic.name);
    if (!index.present() || (!former.empty() && out.count(former) == 0)) continue;
    const Stored* stored = storedFloats(index);
    if (stored == nullptr) continue;
    if (stored->components < semantic.least || stored->components > semantic.most) {
      index.refuse("has vectors of " + std::to_string(stored->components) + " numbers, glTF 2.0 asks for " +
                   std::to_string(semantic.least));
    }
    out[semantic.name] = *stored;
  }
  return out;
}

void GltfMeshWriter::addAttributes(const JsonPlace& place, const Attributes& given, json& out) {
  const std::size_t vertices = given.at("POSITION").count;
  for (const auto& [name, stored] : given) {
    const std::string former = before(name);
    if (!former.empty() && !out["attributes"].contains(former)) continue;
    if (stored.count == vertices) {
      out["attributes"][name] = stored.accessor;
    } else {
      warnings_.push_back("ignored " + place.name() + "." + name + ": it has " + std::to_string(stored.count) +
                          " values for " + std::to_string(vertices) + " vertices");
    }
  }
}

void GltfMeshWriter::addIndices(const JsonPlace& place, const Stored& indices, std::size_t vertices, json& out) {
  if (indices.count > 0 && indices.largest >= vertices) {
    place.refuse("are out of range: index " + std::to_string(indices.largestAt) + " is " +
                 std::to_string(indices.largest) + ", but the primitive has " + std::to_string(vertices) +
                 " vertices, numbered from 0; export it again");
  }
  out["indices"] = indices.accessor;
}

/// False where the mesh is to be read uncompressed: libdraco is not built in and the file has both forms.
bool GltfMeshWriter::addDraco(const JsonPlace& place, const JsonPlace& compressed, json& out) {
  const JsonPlace given = place.at("attributes");
  const auto position = given.at("POSITION").index(root_.at("accessors").size(), "accessors");
  if (!dracoIsBuiltIn() && position && root_.at("accessors").at(*position).at("bufferView").present()) return false;
  const auto view = compressed.at("bufferView").index(root_.at("bufferViews").size(), "bufferViews");
  if (!view) compressed.at("bufferView").refuse("is missing");
  if (!view) return true;
  std::map<std::string, DracoAttribute> wanted;
  for (const Semantic& semantic : kSemantics) {
    const JsonPlace id = compressed.at("attributes").at(semantic.name);
    const auto accessor = given.at(semantic.name).index(root_.at("accessors").size(), "accessors");
    if (!id.present() || !accessor) continue;
    wanted[semantic.name] = {std::uint32_t(id.whole(0)), data_.typeOf(*accessor).normalised};
  }
  const Expected<DracoMesh> mesh = decodeDraco(data_.view(*view), wanted);
  if (!mesh) compressed.refuse(mesh.status().message());
  if (!mesh || mesh->attributes.count("POSITION") == 0) return true;
  Attributes attributes;
  for (const auto& [name, floats] : mesh->attributes) attributes[name] = store(floats);
  addAttributes(place, attributes, out);
  addIndices(compressed, store(mesh->indices), attributes["POSITION"].count, out);
  out["mode"] = 4;
  return true;
}

const GltfMeshWriter::Stored* GltfMeshWriter::storedFloats(const JsonPlace& index) {
  const auto accessor = index.index(root_.at("accessors").size(), "accessors");
  if (!accessor) return nullptr;
  const auto known = floats_.find(*accessor);
  return known != floats_.end() ? &known->second : &(floats_[*accessor] = store(data_.floats(*accessor)));
}

const GltfMeshWriter::Stored* GltfMeshWriter::storedIndices(const JsonPlace& index) {
  const auto accessor = index.index(root_.at("accessors").size(), "accessors");
  if (!accessor) return nullptr;
  const auto known = indices_.find(*accessor);
  return known != indices_.end() ? &known->second : &(indices_[*accessor] = store(data_.indices(*accessor)));
}

GltfMeshWriter::Stored GltfMeshWriter::store(const Floats& floats) {
  static constexpr std::array<const char*, 5> kTypes{"", "SCALAR", "VEC2", "VEC3", "VEC4"};
  Stored out;
  out.accessor = out_["accessors"].size();
  out.count = floats.count();
  out.components = floats.components;
  out_["accessors"].push_back({{"bufferView", addView_(bytesOf(floats.values))},
                               {"componentType", 5126},
                               {"count", out.count},
                               {"type", kTypes[std::min<std::size_t>(floats.components, 4)]}});
  return out;
}

GltfMeshWriter::Stored GltfMeshWriter::store(const std::vector<std::uint32_t>& indices) {
  Stored out;
  out.accessor = out_["accessors"].size();
  out.count = indices.size();
  const auto largest = std::max_element(indices.begin(), indices.end());
  out.largest = largest == indices.end() ? 0 : *largest;
  out.largestAt = std::size_t(largest - indices.begin());
  out_["accessors"].push_back(
      {{"bufferView", addView_(bytesOf(indices))}, {"componentType", 5125}, {"count", out.count}, {"type", "SCALAR"}});
  return out;
}

}  // namespace lpv::cli
