#include "import/gltf_extras.h"

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>

#include "import/file_check.h"

namespace lpv::cli {
namespace {

using google::protobuf::Struct;
using google::protobuf::Value;

/// The JSON of a glTF file: the first chunk of a .glb, all of a .gltf.
std::string jsonOf(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (extensionOf(path) == "glb") {
    std::uint32_t head[5] = {};
    if (!file.read(reinterpret_cast<char*>(head), sizeof(head))) return {};
    std::string json(head[3], '\0');  // checkSceneFile has compared this with the file's size
    file.read(json.data(), std::streamsize(json.size()));
    return file ? json.substr(0, json.find_last_not_of(std::string(" \0", 2)) + 1) : std::string();
  }
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

/// The value at a path of object keys; null if there is none.
const Value* at(const Struct& object, const std::vector<const char*>& keys) {
  const Struct* inside = &object;
  const Value* value = nullptr;
  for (const char* key : keys) {
    if (inside == nullptr) return nullptr;
    const auto found = inside->fields().find(key);
    if (found == inside->fields().end()) return nullptr;
    value = &found->second;
    inside = value->has_struct_value() ? &value->struct_value() : nullptr;
  }
  return value;
}

EmissiveMaterial materialFrom(const Struct& json) {
  EmissiveMaterial out;
  if (const Value* name = at(json, {"name"})) out.name = name->string_value();
  const Value* factor = at(json, {"emissiveFactor"});
  for (int c = 0; factor != nullptr && c < 3 && c < factor->list_value().values_size(); ++c) {
    out.factor[c] = factor->list_value().values(c).number_value();
  }
  const Value* strength = at(json, {"extensions", "KHR_materials_emissive_strength", "emissiveStrength"});
  if (strength != nullptr && std::isfinite(strength->number_value())) out.strength = strength->number_value();
  return out;
}

const google::protobuf::ListValue& listAt(const Struct& object, const char* key) {
  const Value* value = at(object, {key});
  return value == nullptr ? google::protobuf::ListValue::default_instance() : value->list_value();
}

/// yfov of the node's camera, radians; 0 without a camera.
double verticalFovOf(const Struct& node, const google::protobuf::ListValue& cameras) {
  const Value* index = at(node, {"camera"});
  if (index == nullptr || !(index->number_value() >= 0.0 && index->number_value() < cameras.values_size())) return 0.0;
  const Value* fov = at(cameras.values(int(index->number_value())).struct_value(), {"perspective", "yfov"});
  return fov == nullptr ? 0.0 : fov->number_value();
}

}  // namespace

GltfExtras readGltfExtras(const std::string& path) {
  GltfExtras out;
  const std::string extension = extensionOf(path);
  if (extension != "glb" && extension != "gltf") return out;
  Struct json;
  if (!google::protobuf::util::JsonStringToMessage(jsonOf(path), &json).ok()) return out;
  for (const Value& value : listAt(json, "materials").values()) {
    const EmissiveMaterial material = materialFrom(value.struct_value());
    if (material.factor != glm::dvec3(0.0)) out.emissive.push_back(material);
  }
  for (const Value& node : listAt(json, "nodes").values()) {
    const Value* name = at(node.struct_value(), {"name"});
    const double fov = verticalFovOf(node.struct_value(), listAt(json, "cameras"));
    if (name != nullptr && fov > 0.0) out.verticalFov[name->string_value()] = fov;
  }
  return out;
}

double GltfExtras::strengthOf(const std::string& name, const glm::dvec3& factor) const {
  for (const EmissiveMaterial& material : emissive) {
    const glm::dvec3 difference = glm::abs(material.factor - factor);
    if (material.name == name && difference.x + difference.y + difference.z < 1e-5) return material.strength;
  }
  return 1.0;
}

}  // namespace lpv::cli
