#include "renderer/dump.h"

#include <OpenImageIO/imageio.h>

#include <fstream>
#include <map>
#include <sstream>

namespace lpv::evaluation {

namespace {

class Dump {
 public:
  explicit Dump(std::string folder) : folder_(std::move(folder)), bin_(folder_ + "/scene.bin", std::ios::binary) {}

  Status add(const TracedObject& object) {
    std::ostringstream json;
    json.precision(17);
    json << (count_++ == 0 ? "" : ",\n") << "{\"emits\":" << (object.emits ? "true" : "false")
         << ",\"roughness\":" << object.finish.roughness << ",\"metalness\":" << object.finish.metalness
         << ",\"two_sided\":" << (object.twoSided ? "true" : "false") << ",\"colour\":[" << object.colour.x << ","
         << object.colour.y << "," << object.colour.z << "],\"positions\":" << array(object.positions)
         << ",\"normals\":" << array(object.normals) << ",\"uvs\":" << array(object.uvs)
         << ",\"triangles\":" << array(object.triangles);
    if (Status status = addTexture("texture", object.texture.get(), json); !status.ok()) return status;
    if (Status status = addTexture("gloss", object.gloss.get(), json); !status.ok()) return status;
    json_ += json.str() + "}";
    return {};
  }

  Status end() {
    std::ofstream file(folder_ + "/scene.json");
    file << "[" << json_ << "]\n";
    if (!file.flush() || !bin_.flush()) return invalid("dump", folder_ + ": cannot be written to");
    return {};
  }

 private:
  Status addTexture(const char* key, const LinearTexture* texture, std::ostream& json) {
    if (texture == nullptr) return {};
    const auto [known, added] = textures_.emplace(texture, textures_.size());
    const std::string name = "texture-" + std::to_string(known->second) + ".exr";
    json << ",\"" << key << "\":\"" << name << "\"";
    return added ? write(*texture, folder_ + "/" + name) : Status();
  }

  /// [first byte, elements]
  template <typename Value>
  std::string array(const std::vector<Value>& values) {
    const std::string place = "[" + std::to_string(bin_.tellp()) + "," + std::to_string(values.size()) + "]";
    bin_.write(reinterpret_cast<const char*>(values.data()), std::streamsize(values.size() * sizeof(Value)));
    return place;
  }

  static Status write(const LinearTexture& texture, const std::string& path) {
    const OIIO::ImageSpec spec(texture.width(), texture.height(), 3, OIIO::TypeDesc::FLOAT);
    const std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(path);
    if (!out || !out->open(path, spec) || !out->write_image(OIIO::TypeDesc::FLOAT, texture.texels().data()) ||
        !out->close()) {
      return invalid("dump", path + " cannot be written");
    }
    return {};
  }

  std::string folder_;
  std::ofstream bin_;
  std::string json_;
  int count_ = 0;
  std::map<const LinearTexture*, std::size_t> textures_;
};

}  // namespace

Status dumpScene(const TracedScene& scene, const std::string& folder) {
  Dump dump(folder);
  for (const TracedObject& object : scene.objects()) {
    if (Status status = dump.add(object); !status.ok()) return status;
  }
  return dump.end();
}

}  // namespace lpv::evaluation
