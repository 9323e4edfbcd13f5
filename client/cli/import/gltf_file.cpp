#include "import/gltf_file.h"

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <limits>

#include "import/gltf_data.h"
#include "import/gltf_draco.h"
#include "import/gltf_json.h"
#include "import/gltf_materials.h"
#include "import/gltf_meshes.h"
#include "import/gltf_meshopt.h"
#include "import/gltf_nodes.h"
#include "import/text_lines.h"

namespace lpv::cli {
namespace {

using nlohmann::json;

/// Extensions that change nothing of what is read here, and those that are read.
constexpr const char* kKnown[] = {"KHR_mesh_quantization",
                                  "KHR_draco_mesh_compression",
                                  "EXT_meshopt_compression",
                                  "EXT_texture_webp",
                                  "KHR_lights_punctual",
                                  "KHR_materials_anisotropy",
                                  "KHR_materials_clearcoat",
                                  "KHR_materials_dispersion",
                                  "KHR_materials_emissive_strength",
                                  "KHR_materials_ior",
                                  "KHR_materials_iridescence",
                                  "KHR_materials_pbrSpecularGlossiness",
                                  "KHR_materials_sheen",
                                  "KHR_materials_specular",
                                  "KHR_materials_transmission",
                                  "KHR_materials_unlit",
                                  "KHR_materials_variants",
                                  "KHR_materials_volume",
                                  "KHR_texture_transform",
                                  "KHR_xmp_json_ld"};

std::uint32_t uint32At(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  if (at + 4 <= bytes.size()) std::memcpy(&value, bytes.data() + at, 4);
  return value;
}

void appendUint32(std::string& out, std::size_t value) {
  const auto bits = std::uint32_t(value);
  out.append(reinterpret_cast<const char*>(&bits), sizeof(bits));
}

struct Chunks {
  std::string_view json;
  std::string_view binary;
};

/// The chunks of a .glb, whose header checkSceneFile has looked at.
Chunks chunksOf(std::string_view bytes) {
  Chunks out;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t length = std::min<std::size_t>(uint32At(bytes, at), bytes.size() - at - 8);
    const std::string_view type = bytes.substr(at + 4, 4);
    const std::string_view chunk = bytes.substr(at + 8, length);
    if (type == "JSON" && out.json.empty()) out.json = chunk;
    if (type == std::string_view("BIN\0", 4) && out.binary.data() == nullptr) out.binary = chunk;
    at += 8 + length;
  }
  out.json = out.json.substr(0, out.json.find_last_not_of(std::string_view(" \0", 2)) + 1);
  return out;
}

/// glTF 1.0 keeps its meshes in an object; its version may be a number.
bool isVersion1(const json& file) {
  if (!file.is_object() || !file.contains("asset") || !file["asset"].is_object()) return false;
  const json version = file["asset"].value("version", json());
  return version.is_number() ? version.get<double>() < 2.0
                             : version.is_string() && version.get<std::string>().compare(0, 2, "1.") == 0;
}

void checkVersion(const JsonPlace& root) {
  const JsonPlace version = root.at("asset").at("version");
  const std::string text = version.text();
  if (text.compare(0, 2, "2.") != 0) version.refuse("is '" + text + "'; only glTF 2 can be read: convert the file");
}

void checkExtensions(const JsonPlace& required) {
  for (std::size_t i = 0; i < required.size(); ++i) {
    const std::string name = required.at(i).text();
    if (std::find(std::begin(kKnown), std::end(kKnown), name) == std::end(kKnown)) {
      required.refuse("names '" + name + "', which lpvctl does not read; export the file without it");
    }
    const bool missing = (name == "KHR_draco_mesh_compression" && !dracoIsBuiltIn()) ||
                         (name == "EXT_meshopt_compression" && !meshoptIsBuiltIn());
    if (missing) {
      required.refuse("names '" + name +
                      "', and this lpvctl was built without the library that decodes it; export the "
                      "file without it");
    }
  }
}

std::string glbFrom(const json& file, std::string binary) {
  std::string text = file.dump(-1, ' ', false, json::error_handler_t::replace);
  text.append((4 - text.size() % 4) % 4, ' ');
  std::string out = "glTF";
  appendUint32(out, 2);
  appendUint32(out, 12 + 8 + text.size() + 8 + binary.size());
  appendUint32(out, text.size());
  out += "JSON" + text;
  appendUint32(out, binary.size());
  return out + std::string("BIN\0", 4) + binary;
}

/// Cameras with the numbers that glTF 2.0 gives them.
json plainCameras(const JsonPlace& cameras) {
  json out = json::array();
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const std::string type = cameras.at(i).at("type").text();
    json& camera = out.emplace_back(json{{"type", type}, {type, json::object()}});
    for (const char* key : {"yfov", "aspectRatio", "znear", "zfar", "xmag", "ymag"}) {
      const JsonPlace number = cameras.at(i).at(type.c_str()).at(key);
      if (number.present()) camera[type][key] = number.number(0.0);
    }
    if (cameras.at(i).at("name").present()) camera["name"] = cameras.at(i).at("name").text();
  }
  return out;
}

/// Collects the rewritten file's buffer.
class BinaryWriter {
 public:
  explicit BinaryWriter(json& out) : out_(out) { out_["bufferViews"] = json::array(); }
  std::size_t add(std::string_view bytes) {
    out_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bytes_.size()}, {"byteLength", bytes.size()}});
    bytes_ += bytes;
    bytes_.append((4 - bytes_.size() % 4) % 4, '\0');
    return out_["bufferViews"].size() - 1;
  }
  std::string take() {
    out_["buffers"] = {{{"byteLength", bytes_.size()}}};
    return std::move(bytes_);
  }

 private:
  json& out_;
  std::string bytes_;
};

void rewrite(const JsonPlace& root, GltfData& data, PlainGltf& plain) {
  json out = {{"asset", {{"version", "2.0"}}}, {"scene", 0}};
  out["scenes"] = {{{"nodes", rootNodes(root)}}};
  out["nodes"] = plainNodes(root);
  out["cameras"] = plainCameras(root.at("cameras"));
  BinaryWriter writer(out);
  const AddView addView = [&](std::string_view bytes) { return writer.add(bytes); };
  GltfMeshWriter meshes(root, data, addView, out, plain.warnings);
  meshes.addMeshes();
  addPlainMaterials(root, data, addView, out, plain.warnings);
  if (!meshes.anyTriangle()) root.refuse("the file has no triangle; points and lines are not read");
  std::string binary = writer.take();
  if (binary.size() > std::numeric_limits<std::uint32_t>::max() / 2) {
    root.refuse("the file holds more than 2 GB of numbers; split it");
  }
  plain.bytes = glbFrom(out, std::move(binary));
}

}  // namespace

Expected<PlainGltf> plainGltf(std::string_view bytes, bool isBinary, const std::string& folder) {
  const Chunks chunks = isBinary ? chunksOf(bytes) : Chunks{withoutByteOrderMark(bytes), {}};
  const Expected<json> file = parseJson(chunks.json);
  if (!file) return file.status();
  Status problem;
  const JsonPlace root(*file, problem);
  PlainGltf plain;
  if (isVersion1(*file)) {
    plain.rewritten = false;
    plain.bytes = chunks.json;
    return plain;
  }
  checkVersion(root);
  checkExtensions(root.at("extensionsRequired"));
  if (!problem.ok()) return problem;
  GltfData data(root, chunks.binary, folder);
  rewrite(root, data, plain);
  plain.extras = readGltfExtras(root);
  if (!problem.ok()) return problem;
  return plain;
}

}  // namespace lpv::cli
