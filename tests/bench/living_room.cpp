#include "living_room.h"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iostream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "reference/meshes.h"

namespace lpv::bench {

namespace {

using nlohmann::json;

constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr double kBelow = 0.4;  ///< metres, the lamp below the top of all

struct Binary {
  json document;
  std::string bytes;  ///< the binary chunk
};

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  std::cerr << path << ": " << why << "\n";
  std::exit(1);
}

Binary read(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  const std::string all{std::istreambuf_iterator<char>(in), {}};
  std::uint32_t length = 0;
  if (all.size() < kHeader + kChunkHeader) refuse(path, "no glTF binary");
  std::memcpy(&length, &all[kHeader], sizeof length);
  const std::size_t end = kHeader + kChunkHeader + length;
  if (all.size() < end + kChunkHeader) refuse(path, "no glTF binary");
  return {json::parse(all.substr(kHeader + kChunkHeader, length)), all.substr(end + kChunkHeader)};
}

template <typename T>
std::vector<T> values(const Binary& file, std::size_t accessor) {
  const json& a = file.document.at("accessors").at(accessor);
  const json& view = file.document.at("bufferViews").at(a.at("bufferView").get<std::size_t>());
  const std::size_t at = view.value("byteOffset", std::size_t(0)) + a.value("byteOffset", std::size_t(0));
  std::vector<T> out(a.at("count").get<std::size_t>());
  std::memcpy(out.data(), file.bytes.substr(at, out.size() * sizeof(T)).data(), out.size() * sizeof(T));
  return out;
}

MeshPtr meshOf(const Binary& file, const json& primitive, const std::string& path) {
  Mesh mesh;
  mesh.positions = values<glm::vec3>(file, primitive.at("attributes").at("POSITION").get<std::size_t>());
  const auto indices = values<std::uint16_t>(file, primitive.at("indices").get<std::size_t>());
  for (std::size_t i = 0; i + 2 < indices.size(); i += 3)
    mesh.triangles.emplace_back(indices[i], indices[i + 1], indices[i + 2]);
  if (const Status status = finishMesh(mesh); !status.ok()) refuse(path, status.message());
  return std::make_shared<Mesh>(std::move(mesh));
}

}  // namespace

Scene gltfRoom(const std::string& path, int cells) {
  const Binary file = read(path);
  Scene scene;
  for (const json& mesh : file.document.at("meshes")) {
    auto surface = std::make_shared<Surface>();
    surface->name = mesh.at("name").get<std::string>();
    surface->mesh = meshOf(file, mesh.at("primitives").at(0), path);
    scene.surfaces[surface->name] = surface;
  }
  const Bounds bounds = contentBounds(scene);
  auto lamp = std::make_shared<Light>();
  lamp->name = "lamp";
  lamp->mesh = reference::quad();
  lamp->transform.translation = {bounds.centre().x, bounds.max.y - kBelow, bounds.centre().z};
  lamp->transform.rotation = glm::angleAxis(glm::radians(90.0), glm::dvec3(1, 0, 0));
  scene.lights["lamp"] = lamp;
  GridOptions options;
  options.longest = cells;
  const Expected<Grid> grid = fitGrid(options, bounds);
  if (!grid.ok()) refuse(path, grid.status().message());
  scene.grid = *grid;
  return scene;
}

}  // namespace lpv::bench
