// Says what the importer makes of scene files: one line of JSON per file named on the command line, or on stdin.

#include <cstdint>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "import/scene_file.h"

namespace lpv::cli {
namespace {

/// FNV-1a over everything that an import yields, so that two versions of the importer can be compared.
class Fingerprint {
 public:
  void add(const void* bytes, std::size_t size) {
    for (std::size_t i = 0; i < size; ++i) {
      value_ = (value_ ^ static_cast<const unsigned char*>(bytes)[i]) * 0x100000001b3ULL;
    }
  }
  template <typename T>
  void add(const std::vector<T>& values) {
    add(values.data(), values.size() * sizeof(T));
  }
  void add(const std::string& text) { add(text.data(), text.size()); }
  void add(const glm::dvec3& value) { add(&value, sizeof(value)); }
  void add(const glm::dmat4& value) { add(&value, sizeof(value)); }
  void add(double value) { add(&value, sizeof(value)); }
  std::string text() const { return std::to_string(value_); }

 private:
  std::uint64_t value_ = 0xcbf29ce484222325ULL;
};

void addMesh(const Mesh& mesh, Fingerprint& print) {
  print.add(mesh.positions);
  print.add(mesh.normals);
  print.add(mesh.uvs);
  print.add(mesh.triangles);
}

void addTexture(const TexturePtr& texture, Fingerprint& print) {
  if (texture) print.add(texture->texels);
}

nlohmann::json reportOf(const ImportedScene& scene) {
  Fingerprint print;
  std::size_t triangles = 0;
  double area = 0.0;
  const auto addObject = [&](const auto& object) {
    triangles += object.mesh->triangles.size();
    area += worldArea(*object.mesh, object.transform);
    print.add(object.name);
    print.add(object.transform.worldFromObject());
    print.add(double(object.twoSided));
    addMesh(*object.mesh, print);
  };
  for (const Light& light : scene.lights) {
    addObject(light);
    print.add(light.radiance);
    addTexture(light.texture, print);
  }
  for (const Surface& surface : scene.surfaces) {
    addObject(surface);
    print.add(surface.albedo);
    print.add(glm::dvec3(surface.roughness, surface.metalness, 0.0));
    addTexture(surface.albedoTexture, print);
  }
  for (const auto& [name, camera] : scene.cameras) {
    print.add(name);
    print.add(camera.eye);
    print.add(camera.target);
    print.add(camera.up);
    print.add(glm::dvec3(camera.fovDegrees, camera.near, camera.far));
  }
  return {{"triangles", triangles},          {"area", area},
          {"lights", scene.lights.size()},   {"surfaces", scene.surfaces.size()},
          {"cameras", scene.cameras.size()}, {"warnings", scene.warnings},
          {"fingerprint", print.text()}};
}

void report(const std::string& path) {
  const Expected<ImportedScene> scene = importScene(path, {});
  nlohmann::json line = scene ? reportOf(*scene) : nlohmann::json{{"refused", scene.status().message()}};
  line["file"] = path;
  std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << std::endl;
}

}  // namespace
}  // namespace lpv::cli

int main(int count, char** arguments) {
  for (int i = 1; i < count; ++i) lpv::cli::report(arguments[i]);
  for (std::string path; count == 1 && std::getline(std::cin, path);) lpv::cli::report(path);
}
