#pragma once
// The numbers of a glTF file: buffers, buffer views and accessors.

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "import/gltf_json.h"

namespace lpv::cli {

/// Vectors of floats, one after the other.
struct Floats {
  unsigned components = 0;  ///< of a vector
  std::vector<float> values;
  std::size_t count() const { return components == 0 ? 0 : values.size() / components; }
};

/// How an accessor's numbers are stored.
struct AccessorType {
  int component = 5126;  ///< 5120 int8, 5121 uint8, 5122 int16, 5123 uint16, 5125 uint32, 5126 float
  unsigned components = 1;
  bool normalised = false;

  std::size_t componentBytes() const { return component < 5122 ? 1 : component < 5124 ? 2 : 4; }
  std::size_t bytes() const { return components * componentBytes(); }
};

/// Bytes of a data: address, or none if it is no such address or not base64.
std::optional<std::string> dataFromUri(const std::string& uri);

/// Decodes "%20" and the like.
std::string percentDecoded(std::string_view uri);

/// Reads what is asked for and keeps it. A place that is wrong makes the file's problem and reads as nothing.
class GltfData {
 public:
  GltfData(JsonPlace root, std::string_view binaryChunk, std::string folder);

  /// The bytes of a buffer view; EXT_meshopt_compression is decoded.
  std::string_view view(std::size_t index);

  AccessorType typeOf(std::size_t accessor) const;
  std::size_t countOf(std::size_t accessor) const;
  /// Converted as KHR_mesh_quantization and the accessor's `normalized` say; sparse values are put in.
  Floats floats(std::size_t accessor);
  /// A SCALAR accessor of unsigned whole numbers.
  std::vector<std::uint32_t> indices(std::size_t accessor);

 private:
  std::string_view buffer(std::size_t index);
  std::optional<std::string> load(const JsonPlace& place) const;
  std::string_view slice(const JsonPlace& place, std::string_view bytes, std::size_t offset, std::size_t length) const;
  std::string_view storedView(const JsonPlace& place);
  std::string_view meshoptView(std::size_t index, const JsonPlace& compressed);
  std::vector<double> elements(const JsonPlace& place, AccessorType type, std::size_t count);
  std::vector<double> valuesOf(std::size_t accessor);
  void addSparse(const JsonPlace& sparse, AccessorType type, std::vector<double>& values);

  JsonPlace root_;
  std::string_view binaryChunk_;
  std::string folder_;
  std::map<std::size_t, std::string> buffers_;
  std::map<std::size_t, std::string> meshopt_;
};

}  // namespace lpv::cli
