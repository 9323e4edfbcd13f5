// Meshes and textures from bytes, as uploads and edits bring them: what is refused says why; what is accepted can be
// used by everything that reads a mesh, and is the same after its way over the wire.
//
// Has found normals that changed in their last bits on every way over the wire (seeds/meshes/renormalised). Seen to
// find an index that is not compared with the number of positions (finishMesh).

#include <fuzzer/FuzzedDataProvider.h>

#include <cmath>

#include "convert/blob_content.h"
#include "fuzz/check.h"
#include "scene/raycast.h"

namespace lpv::fuzz {
namespace {

namespace pb = lpv::v1;

constexpr int kMostVertices = 24;

/// Floats of all kinds, undefined ones too.
std::string floats(FuzzedDataProvider& in, std::size_t count) {
  std::string out;
  for (std::size_t i = 0; i < count; ++i) {
    const float value =
        in.ConsumeBool() ? in.ConsumeFloatingPointInRange(-8.0F, 8.0F) : in.ConsumeFloatingPoint<float>();
    out.append(reinterpret_cast<const char*>(&value), sizeof value);
  }
  return out;
}

std::string indices(FuzzedDataProvider& in, std::size_t triangles, std::size_t vertices) {
  std::string out;
  for (std::size_t i = 0; i < 3 * triangles; ++i) {
    const auto index = in.ConsumeIntegralInRange<std::uint32_t>(0, std::uint32_t(vertices));  // one too many
    out.append(reinterpret_cast<const char*>(&index), sizeof index);
  }
  return out;
}

/// A mesh that is nearly right.
std::string meshLike(FuzzedDataProvider& in) {
  pb::Mesh mesh;
  const auto vertices = std::size_t(in.ConsumeIntegralInRange(0, kMostVertices));
  const auto some = [&](std::size_t elements) {
    const int way = in.ConsumeIntegralInRange(0, 7);
    return way < 4 ? std::string() : floats(in, elements * (vertices + (way == 7 ? 1 : 0)));
  };
  mesh.set_positions(floats(in, 3 * vertices));
  mesh.set_indices(indices(in, std::size_t(in.ConsumeIntegralInRange(0, kMostVertices)), vertices));
  mesh.set_normals(some(3));
  mesh.set_uvs(some(2));
  mesh.set_directions(some(3));
  return mesh.SerializeAsString();
}

std::string textureLike(FuzzedDataProvider& in) {
  pb::Texture texture;
  const int width = in.ConsumeIntegralInRange(-1, 16);
  const int height = in.ConsumeIntegralInRange(-1, 16);
  texture.set_width(in.ConsumeBool() ? width : in.ConsumeIntegral<int>());
  texture.set_height(height);
  texture.set_format(pb::TextureFormat(in.ConsumeIntegralInRange(0, 4)));
  const int bytes = width * height * 3 * (1 << in.ConsumeIntegralInRange(0, 2));
  texture.set_texels(in.ConsumeBytesAsString(std::size_t(std::max(bytes, 0))));
  if (in.ConsumeBool()) texture.mutable_texels()->resize(std::size_t(std::max(bytes, 0)));
  return texture.SerializeAsString();
}

bool isFinite(const glm::dvec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

void useMesh(const MeshPtr& mesh, FuzzedDataProvider& in) {
  for (const glm::uvec3& triangle : mesh->triangles) {
    for (int corner = 0; corner < 3; ++corner) {
      check(triangle[corner] < mesh->positions.size(), "every index of an accepted mesh has a position");
    }
  }
  for (const glm::vec3& p : mesh->positions) check(isFinite(p), "positions of an accepted mesh are finite");
  for (const glm::vec3& n : mesh->normals) check(isFinite(n), "normals of an accepted mesh are finite");
  check(degenerateTriangles(*mesh) <= mesh->triangles.size(), "no more triangles are degenerate than there are");
  check(worldArea(*mesh, Transform()) >= 0.0, "an area is a number");
  const Expected<Mesh> again = api::meshFromProto(api::meshToProto(*mesh));
  check(again.ok() && api::meshBytes(*again) == api::meshBytes(*mesh), "a mesh survives the wire");
  Scene scene;
  auto surface = std::make_shared<Surface>();
  surface->name = "Mesh";
  surface->mesh = mesh;
  scene.surfaces["Mesh"] = surface;
  const std::optional<Hit> hit = raycast(scene, glm::dvec3(0.1, 0.2, 5.0), glm::dvec3(0.0, 0.0, -1.0));
  check(!hit || hit->distance >= 0.0, "a ray meets what is before it");
  std::vector<glm::vec3> moved = mesh->positions;
  for (glm::vec3& p : moved) p = {in.ConsumeFloatingPoint<float>(), p.x, p.y};
  const Expected<Mesh> deformed = withVertices(*mesh, moved, {});
  if (!deformed) checkRefusal(deformed.status());
}

void useTexture(const Texture& texture) {
  std::vector<glm::vec3> rows;
  for (int row = 0; row < texture.height; ++row) appendLinearRow(texture, row, rows);
  check(rows.size() == std::size_t(texture.width) * std::size_t(texture.height), "a texture has all its texels");
  for (const glm::vec3& texel : rows) {
    check(isFinite(texel) && texel.x >= 0.0F && texel.y >= 0.0F && texel.z >= 0.0F, "texels are light");
  }
}

void run(FuzzedDataProvider& in) {
  const pb::BlobKind kind = in.ConsumeBool() ? pb::BLOB_KIND_MESH : pb::BLOB_KIND_TEXTURE;
  const std::string bytes = in.ConsumeIntegralInRange(0, 3) == 0 ? in.ConsumeRandomLengthString()
                            : kind == pb::BLOB_KIND_MESH         ? meshLike(in)
                                                                 : textureLike(in);
  const Expected<BlobPtr> blob = api::blobFromBytes(kind, bytes);
  if (!blob) return checkRefusal(blob.status());
  check((*blob)->hash == sha256(bytes), "a blob is named by its bytes");
  if ((*blob)->mesh) useMesh((*blob)->mesh, in);
  if ((*blob)->texture) useTexture(*(*blob)->texture);
}

}  // namespace
}  // namespace lpv::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzedDataProvider in(data, size);
  lpv::fuzz::run(in);
  return 0;
}
