#include "convert/blob_content.h"

#include <google/protobuf/io/coded_stream.h>
#include <google/protobuf/io/zero_copy_stream_impl_lite.h>

#include <bit>
#include <cstring>

namespace lpv::api {
namespace {

static_assert(std::endian::native == std::endian::little, "wire arrays are little-endian and are copied as they are");

/// Copies a packed array. The element's size is `sizeof(T)` on the wire.
template <typename T>
Expected<std::vector<T>> arrayFromBytes(const char* field, const std::string& bytes) {
  if (bytes.size() % sizeof(T) != 0) {
    return invalid(field, std::string(field) + " has " + std::to_string(bytes.size()) + " bytes, no multiple of " +
                              std::to_string(sizeof(T)));
  }
  std::vector<T> out(bytes.size() / sizeof(T));
  if (!out.empty()) std::memcpy(static_cast<void*>(out.data()), bytes.data(), bytes.size());
  return out;
}

template <typename T>
std::string bytesOf(const std::vector<T>& array) {
  return std::string(reinterpret_cast<const char*>(array.data()), array.size() * sizeof(T));
}

static_assert(sizeof(glm::vec3) == 12 && sizeof(glm::uvec3) == 12 && sizeof(glm::vec2) == 8);

Expected<TexelFormat> formatFromProto(pb::TextureFormat format) {
  switch (format) {
    case pb::TEXTURE_FORMAT_RGB8_SRGB:
      return TexelFormat::kRgb8Srgb;
    case pb::TEXTURE_FORMAT_RGB16F:
      return TexelFormat::kRgb16F;
    case pb::TEXTURE_FORMAT_RGB32F:
      return TexelFormat::kRgb32F;
    case pb::TEXTURE_FORMAT_RGBA8_SRGB:
      return TexelFormat::kRgba8Srgb;
    case pb::TEXTURE_FORMAT_RGB8_LINEAR:
      return TexelFormat::kRgb8;
    default:
      return invalid("format", "format has the unknown value " + std::to_string(int(format)));
  }
}

Expected<Texture> textureFromProto(pb::Texture& message) {
  const Expected<TexelFormat> format = formatFromProto(message.format());
  if (!format) return format.status();
  Texture texture;
  texture.width = message.width();
  texture.height = message.height();
  texture.format = *format;
  texture.texels.assign(message.texels().begin(), message.texels().end());
  if (Status s = checkTexture(texture); !s.ok()) return s;
  return texture;
}

Status unreadable(const char* what) {
  return invalid("data", std::string("data does not parse as a ") + what + " message; it may be cut short");
}

}  // namespace

Expected<std::vector<glm::vec3>> vec3sFromBytes(const char* field, const std::string& bytes) {
  return arrayFromBytes<glm::vec3>(field, bytes);
}

Expected<Mesh> meshFromProto(const pb::Mesh& message) {
  Expected<std::vector<glm::vec3>> positions = arrayFromBytes<glm::vec3>("positions", message.positions());
  if (!positions) return positions.status();
  Expected<std::vector<glm::uvec3>> triangles = arrayFromBytes<glm::uvec3>("indices", message.indices());
  if (!triangles) return triangles.status();
  Expected<std::vector<glm::vec3>> normals = arrayFromBytes<glm::vec3>("normals", message.normals());
  if (!normals) return normals.status();
  Expected<std::vector<glm::vec2>> uvs = arrayFromBytes<glm::vec2>("uvs", message.uvs());
  if (!uvs) return uvs.status();
  Expected<std::vector<glm::vec3>> directions = arrayFromBytes<glm::vec3>("directions", message.directions());
  if (!directions) return directions.status();
  Mesh mesh;
  mesh.positions = std::move(*positions);
  mesh.triangles = std::move(*triangles);
  mesh.normals = std::move(*normals);
  mesh.uvs = std::move(*uvs);
  mesh.directions = std::move(*directions);
  if (Status s = finishMesh(mesh); !s.ok()) return s;
  return mesh;
}

pb::Mesh meshToProto(const Mesh& mesh) {
  pb::Mesh out;
  out.set_positions(bytesOf(mesh.positions));
  out.set_indices(bytesOf(mesh.triangles));
  out.set_normals(bytesOf(mesh.normals));
  out.set_uvs(bytesOf(mesh.uvs));
  out.set_directions(bytesOf(mesh.directions));
  return out;
}

std::string meshBytes(const Mesh& mesh) {
  std::string bytes;
  google::protobuf::io::StringOutputStream stream(&bytes);
  google::protobuf::io::CodedOutputStream coded(&stream);
  coded.SetSerializationDeterministic(true);
  meshToProto(mesh).SerializeToCodedStream(&coded);
  coded.Trim();
  return bytes;
}

BlobHash meshHash(const Mesh& mesh) { return sha256(meshBytes(mesh)); }

Expected<BlobPtr> blobFromBytes(pb::BlobKind kind, std::string given) {
  auto blob = std::make_shared<Blob>();
  blob->bytes = std::make_shared<const std::string>(std::move(given));
  const std::string& bytes = *blob->bytes;
  blob->hash = sha256(bytes);
  if (kind == pb::BLOB_KIND_MESH) {
    pb::Mesh message;
    if (!message.ParseFromString(bytes)) return unreadable("Mesh");
    Expected<Mesh> mesh = meshFromProto(message);
    if (!mesh) return mesh.status();
    mesh->hash = blob->hash;
    if (meshBytes(*mesh) != bytes) mesh->source = blob->bytes;
    blob->kind = BlobKind::kMesh;
    blob->mesh = std::make_shared<const Mesh>(std::move(*mesh));
  } else {
    pb::Texture message;
    if (!message.ParseFromString(bytes)) return unreadable("Texture");
    Expected<Texture> texture = textureFromProto(message);
    if (!texture) return texture.status();
    texture->hash = blob->hash;
    blob->kind = BlobKind::kTexture;
    blob->texture = std::make_shared<const Texture>(std::move(*texture));
  }
  return BlobPtr(std::move(blob));
}

Expected<MeshPtr> inlineMesh(const pb::Mesh& message) {
  Expected<Mesh> mesh = meshFromProto(message);
  if (!mesh) return mesh.status();
  mesh->hash = meshHash(*mesh);
  return MeshPtr(std::make_shared<const Mesh>(std::move(*mesh)));
}

}  // namespace lpv::api
