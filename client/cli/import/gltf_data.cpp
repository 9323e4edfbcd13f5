#include "import/gltf_data.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "import/gltf_meshopt.h"

namespace lpv::cli {
namespace {

constexpr std::size_t kMostElements = std::size_t(1) << 26;  ///< numbers that one accessor may have: 512 MB as double

std::optional<std::string> fromBase64(std::string_view text) {
  std::string out;
  std::uint32_t bits = 0;
  int count = 0;
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  for (const char c : text) {
    const int value = c >= 'A' && c <= 'Z'   ? c - 'A'
                      : c >= 'a' && c <= 'z' ? c - 'a' + 26
                      : c >= '0' && c <= '9' ? c - '0' + 52
                      : c == '+' || c == '-' ? 62
                      : c == '/' || c == '_' ? 63
                                             : -1;
    if (value < 0) return {};
    bits = (bits << 6U) | std::uint32_t(value);
    if (++count % 4 != 1) out += char(bits >> (6U - 2U * unsigned((count - 1) % 4)));
  }
  return out;
}

double componentAt(const char* at, AccessorType type) {
  const auto as = [&](auto value, double largest) {
    std::memcpy(&value, at, sizeof(value));
    return type.normalised ? std::max(double(value) / largest, -1.0) : double(value);
  };
  switch (type.component) {
    case 5120:
      return as(std::int8_t(), 127.0);
    case 5121:
      return as(std::uint8_t(), 255.0);
    case 5122:
      return as(std::int16_t(), 32767.0);
    case 5123:
      return as(std::uint16_t(), 65535.0);
    case 5125:
      return as(std::uint32_t(), 4294967295.0);
    default:
      return as(0.0F, 1.0);
  }
}

int componentTypeOf(const JsonPlace& place) {
  const std::size_t type = place.whole(0);
  const bool known = type >= 5120 && type <= 5126 && type != 5124;
  if (!known) place.refuse("is " + std::to_string(type) + "; 5120 to 5123, 5125 and 5126 are known");
  return known ? int(type) : 5126;
}

}  // namespace

std::optional<std::string> dataFromUri(const std::string& uri) {
  if (uri.compare(0, 5, "data:") != 0) return {};
  const std::size_t comma = uri.find(',');
  if (comma == std::string::npos || uri.substr(0, comma).find(";base64") == std::string::npos) return {};
  return fromBase64(std::string_view(uri).substr(comma + 1));
}

std::string percentDecoded(std::string_view uri) {
  std::string out;
  const auto isHex = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const bool escape = uri[i] == '%' && i + 2 < uri.size() && isHex(uri[i + 1]) && isHex(uri[i + 2]);
    out += escape ? char(std::stoi(std::string(uri.substr(i + 1, 2)), nullptr, 16)) : uri[i];
    if (escape) i += 2;
  }
  return out;
}

GltfData::GltfData(JsonPlace root, std::string_view binaryChunk, std::string folder)
    : root_(std::move(root)), binaryChunk_(binaryChunk), folder_(std::move(folder)) {}

std::optional<std::string> GltfData::load(const JsonPlace& place) const {
  const std::string uri = place.text();
  if (uri.compare(0, 5, "data:") == 0) {
    std::optional<std::string> data = dataFromUri(uri);
    if (!data) place.refuse("is a data: address that is not base64; export the file again");
    return data;
  }
  const std::string shown = uri.substr(0, 200);
  if (uri.find("://") != std::string::npos) {
    place.refuse("is '" + shown + "'; only files beside this one can be read: download it");
    return {};
  }
  std::error_code error;
  const std::filesystem::path path = std::filesystem::path(folder_) / percentDecoded(uri);
  std::ifstream file(path, std::ios::binary);
  if (!file || !std::filesystem::is_regular_file(path, error)) {
    place.refuse("is '" + shown + "'; there is no such file beside this one");
    return {};
  }
  return std::string((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
}

std::string_view GltfData::buffer(std::size_t index) {
  const JsonPlace place = root_.at("buffers").at(index);
  const std::size_t length = place.at("byteLength").whole(0);
  const JsonPlace uri = place.at("uri");
  if (uri.present() && buffers_.find(index) == buffers_.end()) buffers_[index] = load(uri).value_or("");
  const std::string_view bytes = uri.present() ? std::string_view(buffers_[index])
                                 : index == 0  ? binaryChunk_
                                               : std::string_view();
  return slice(place, bytes, 0, length);
}

std::string_view GltfData::slice(const JsonPlace& place, std::string_view bytes, std::size_t offset,
                                 std::size_t length) const {
  if (offset <= bytes.size() && length <= bytes.size() - offset) return bytes.substr(offset, length);
  place.refuse("reaches to byte " + std::to_string(offset + length) + ", but there are " +
               std::to_string(bytes.size()) + " bytes; the file is damaged or cut short: copy or export it again");
  return {};
}

std::string_view GltfData::storedView(const JsonPlace& place) {
  const auto index = place.at("buffer").index(root_.at("buffers").size(), "buffers");
  if (!index) place.at("buffer").refuse("is missing");
  return index ? slice(place, buffer(*index), place.at("byteOffset").whole(0), place.at("byteLength").whole(0))
               : std::string_view();
}

std::string_view GltfData::view(std::size_t index) {
  const JsonPlace place = root_.at("bufferViews").at(index);
  const JsonPlace compressed = place.at("extensions").at("EXT_meshopt_compression");
  return compressed.present() ? meshoptView(index, compressed) : storedView(place);
}

std::string_view GltfData::meshoptView(std::size_t index, const JsonPlace& compressed) {
  const auto known = meshopt_.find(index);
  if (known != meshopt_.end()) return known->second;
  MeshoptView view;
  view.bytes = storedView(compressed);
  view.count = compressed.at("count").whole(0);
  view.stride = compressed.at("byteStride").whole(0);
  view.mode = compressed.at("mode").text();
  view.filter = compressed.at("filter").present() ? compressed.at("filter").text() : "NONE";
  Expected<std::string> decoded = decodeMeshopt(view);
  if (!decoded) compressed.refuse(decoded.status().message());
  return meshopt_[index] = decoded ? std::move(*decoded) : std::string();
}

AccessorType GltfData::typeOf(std::size_t accessor) const {
  const JsonPlace place = root_.at("accessors").at(accessor);
  AccessorType type;
  type.component = componentTypeOf(place.at("componentType"));
  type.normalised = place.at("normalized").flag();
  const std::string name = place.at("type").text();
  constexpr std::array<const char*, 4> kVectors{"SCALAR", "VEC2", "VEC3", "VEC4"};
  const auto found = std::find(kVectors.begin(), kVectors.end(), name);
  if (found == kVectors.end()) place.at("type").refuse("is '" + name + "'; SCALAR, VEC2, VEC3 and VEC4 are read here");
  type.components = found == kVectors.end() ? 1 : unsigned(found - kVectors.begin()) + 1;
  return type;
}

std::size_t GltfData::countOf(std::size_t accessor) const {
  const JsonPlace count = root_.at("accessors").at(accessor).at("count");
  if (count.whole(0) <= kMostElements / 4) return count.whole(0);
  count.refuse("is " + std::to_string(count.whole(0)) + "; at most " + std::to_string(kMostElements / 4) +
               " can be read: split the mesh");
  return 0;
}

std::vector<double> GltfData::elements(const JsonPlace& place, AccessorType type, std::size_t count) {
  std::vector<double> out(count * type.components);
  const auto index = place.at("bufferView").index(root_.at("bufferViews").size(), "bufferViews");
  if (!index || count == 0) return out;
  const std::size_t stride = root_.at("bufferViews").at(*index).at("byteStride").whole(type.bytes());
  if (stride < type.bytes() || stride > 252) {
    root_.at("bufferViews")
        .at(*index)
        .at("byteStride")
        .refuse("is " + std::to_string(stride) + "; " + std::to_string(type.bytes()) + " to 252 are allowed");
    return out;
  }
  const std::size_t offset = place.at("byteOffset").whole(0);
  const std::string_view bytes = slice(place, view(*index), offset, (count - 1) * stride + type.bytes());
  for (std::size_t i = 0; i < out.size() && !bytes.empty(); ++i) {
    const std::size_t at = i / type.components * stride + i % type.components * type.componentBytes();
    out[i] = componentAt(bytes.data() + at, type);
  }
  return out;
}

std::vector<double> GltfData::valuesOf(std::size_t accessor) {
  const JsonPlace place = root_.at("accessors").at(accessor);
  const AccessorType type = typeOf(accessor);
  std::vector<double> values = elements(place, type, countOf(accessor));
  if (place.at("sparse").present()) addSparse(place.at("sparse"), type, values);
  return values;
}

void GltfData::addSparse(const JsonPlace& sparse, AccessorType type, std::vector<double>& values) {
  const std::size_t count = sparse.at("count").whole(0);
  const std::size_t places = values.size() / type.components;
  if (count > places) {
    sparse.at("count").refuse("is " + std::to_string(count) + ", but the accessor has " + std::to_string(places) +
                              " elements");
    return;
  }
  AccessorType indexType;
  indexType.component = componentTypeOf(sparse.at("indices").at("componentType"));
  const std::vector<double> indices = elements(sparse.at("indices"), indexType, count);
  const std::vector<double> changed = elements(sparse.at("values"), type, count);
  for (std::size_t i = 0; i < count; ++i) {
    if (!(indices[i] >= 0.0 && indices[i] < double(places))) {
      sparse.at("indices").refuse("has the index " + std::to_string(std::int64_t(indices[i])) +
                                  ", but the accessor has " + std::to_string(places) + " elements; export it again");
      return;
    }
    for (unsigned c = 0; c < type.components; ++c) {
      values[std::size_t(indices[i]) * type.components + c] = changed[i * type.components + c];
    }
  }
}

Floats GltfData::floats(std::size_t accessor) {
  const std::vector<double> values = valuesOf(accessor);
  return {typeOf(accessor).components, std::vector<float>(values.begin(), values.end())};
}

std::vector<std::uint32_t> GltfData::indices(std::size_t accessor) {
  AccessorType type = typeOf(accessor);
  const bool whole = type.component == 5121 || type.component == 5123 || type.component == 5125;
  if (!whole || type.components != 1) {
    root_.at("accessors").at(accessor).refuse("holds indices, which are SCALAR of type 5121, 5123 or 5125");
    return {};
  }
  const std::vector<double> values = valuesOf(accessor);
  return std::vector<std::uint32_t>(values.begin(), values.end());
}

}  // namespace lpv::cli
