#pragma once
// Scene files made by the tests, byte by byte.

#include <unistd.h>
#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

namespace lpv::cli {

/// A folder of the test's own, removed with it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "lpv-cli-XXXXXX").string();
    path_ = mkdtemp(pattern.data());
  }
  ~TemporaryFolder() {
    std::error_code error;
    std::filesystem::remove_all(path_, error);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string path(const std::string& name) const { return path_ + "/" + name; }
  std::string write(const std::string& name, const std::string& bytes) const {
    std::ofstream(path(name), std::ios::binary).write(bytes.data(), std::streamsize(bytes.size()));
    return path(name);
  }

 private:
  std::string path_;
};

template <typename T>
std::string bytesOf(const std::vector<T>& values) {
  return std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T));
}

/// 2 x 1 texels, 8 bits: red, green.
inline std::string redGreenPng() {
  constexpr std::array<unsigned char, 72> kBytes = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
      0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x02, 0x00, 0x00, 0x00, 0x7b, 0x40, 0xe8, 0xdd, 0x00, 0x00, 0x00,
      0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xc0, 0xf0, 0x9f, 0x01, 0x00, 0x07, 0xff,
      0x01, 0xff, 0xb8, 0x04, 0x35, 0xe0, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return std::string(reinterpret_cast<const char*>(kBytes.data()), kBytes.size());
}

/// 2 x 1 texels, 8 bits: red, green with an alpha of 64.
inline std::string halfClearPng() {
  constexpr std::array<unsigned char, 72> kBytes = {
      0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d, 0x49, 0x48, 0x44, 0x52, 0x00, 0x00,
      0x00, 0x02, 0x00, 0x00, 0x00, 0x01, 0x08, 0x06, 0x00, 0x00, 0x00, 0xf4, 0x22, 0x7f, 0x8a, 0x00, 0x00, 0x00,
      0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xf0, 0x1f, 0x08, 0x1d, 0x00, 0x10, 0x39,
      0x03, 0x3e, 0x14, 0x07, 0x5d, 0xdd, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
  return std::string(reinterpret_cast<const char*>(kBytes.data()), kBytes.size());
}

/// One unit square in the plane z = 0 facing +z, with uvs; then the picture. Used by gltfJson.
inline std::string gltfBuffer() {
  std::string buffer = bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});       // 0: positions, 48 bytes
  buffer += bytesOf<float>({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1});                  // 48: normals, 48 bytes
  buffer += bytesOf<float>({0, 1, 1, 1, 1, 0, 0, 0});                              // 96: uvs, 32 bytes
  buffer += bytesOf<std::uint16_t>({0, 1, 2, 0, 2, 3});                            // 128: indices, 12 bytes
  return buffer + redGreenPng();                                                   // 140: 72 bytes
}

/// A scene of one mesh in four nodes (lamp, screen, floor, slanted) and a camera; `nodes` may replace the nodes.
inline std::string gltfJson(const std::string& bufferUri = "") {
  const std::string uri = bufferUri.empty() ? "" : R"("uri":")" + bufferUri + R"(",)";
  return R"({"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0,1,2,3,5]}],
"extensionsUsed":["KHR_materials_emissive_strength"],
"buffers":[{)" +
         uri + R"("byteLength":212}],
"bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":48},
{"buffer":0,"byteOffset":96,"byteLength":32},{"buffer":0,"byteOffset":128,"byteLength":12},
{"buffer":0,"byteOffset":140,"byteLength":72}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5126,"count":4,"type":"VEC3"},{"bufferView":2,"componentType":5126,"count":4,"type":"VEC2"},
{"bufferView":3,"componentType":5123,"count":6,"type":"SCALAR"}],
"images":[{"bufferView":4,"mimeType":"image/png"}],"textures":[{"source":0}],
"materials":[
{"name":"unused"},
{"name":"floor","pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0.125,1],"roughnessFactor":0.5,"metallicFactor":0.25,
"baseColorTexture":{"index":0}}},
{"name":"lamp","emissiveFactor":[1,0.5,0.25],"doubleSided":true,
"extensions":{"KHR_materials_emissive_strength":{"emissiveStrength":8}}},
{"name":"screen","emissiveFactor":[1,1,1],"emissiveTexture":{"index":0}}],
"meshes":[
{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,"material":2}]},
{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,"material":3}]},
{"primitives":[{"attributes":{"POSITION":0,"NORMAL":1,"TEXCOORD_0":2},"indices":3,"material":1}]}],
"cameras":[{"type":"perspective","perspective":{"yfov":0.8,"aspectRatio":2,"znear":0.1,"zfar":50}}],
"nodes":[
{"name":"Lamp","mesh":0,"translation":[1,2,3],"rotation":[0,0.70710678,0,0.70710678],"scale":[2,2,2]},
{"name":"Screen","mesh":1},
{"name":"Floor/1","mesh":2},
{"name":"Squash","scale":[1,3,1],"children":[4]},
{"name":"Slanted","mesh":2,"rotation":[0,0,0.38268343,0.92387953]},
{"name":"View","camera":0,"translation":[0,1,5]}]})";
}

inline std::string uint32Bytes(std::uint32_t value) {
  std::string out(4, '\0');
  std::memcpy(out.data(), &value, 4);
  return out;
}

inline std::string glb(std::string json, std::string buffer) {
  json.append((4 - json.size() % 4) % 4, ' ');
  buffer.append((4 - buffer.size() % 4) % 4, '\0');
  const auto total = std::uint32_t(12 + 8 + json.size() + 8 + buffer.size());
  return "glTF" + uint32Bytes(2) + uint32Bytes(total) + uint32Bytes(std::uint32_t(json.size())) + "JSON" + json +
         uint32Bytes(std::uint32_t(buffer.size())) + std::string("BIN\0", 4) + buffer;
}

/// Negative indices, a quadrilateral, a material with Ke and one without.
inline std::string objText() {
  return "mtllib room.mtl\n"
         "v 0 0 0\nv 2 0 0\nv 2 0 2\nv 0 0 2\ng floor\nusemtl white\nf -4 -1 -2 -3\n"
         "v 0 3 0\nv 1 3 0\nv 1 3 1\ng lamp\nusemtl glow\nf -3 -2 -1\n";
}
inline std::string mtlText() { return "newmtl white\nKd 0.7 0.6 0.5\nKe 0 0 0\nnewmtl glow\nKd 0 0 0\nKe 17 12 4\n"; }

inline std::string asciiPly() {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
         "0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n";
}
inline std::string binaryPly() {
  std::string out =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  out += bytesOf<float>({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0});
  out += '\3' + bytesOf<std::int32_t>({0, 1, 2});
  return out + '\3' + bytesOf<std::int32_t>({0, 2, 3});
}

inline std::string binaryStl() {
  std::string out(80, ' ');
  out += uint32Bytes(2);
  out += bytesOf<float>({0, 0, 1, 0, 0, 0, 1, 0, 0, 1, 1, 0}) + std::string(2, '\0');
  return out + bytesOf<float>({0, 0, 1, 0, 0, 0, 1, 1, 0, 0, 1, 0}) + std::string(2, '\0');
}
inline std::string asciiStl() {
  return "solid part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1 1 0\n"
         "  endloop\n endfacet\nendsolid part\n";
}

}  // namespace lpv::cli
