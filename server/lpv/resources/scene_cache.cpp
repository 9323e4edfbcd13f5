#include "lpv/resources/scene_cache.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <vector>

#include "gpu/gl.h"
#include "lpv/pacing/chunked.h"
#include "scene/gloss.h"

namespace lpv {

namespace {

constexpr std::size_t kUploadPieceBytes = std::size_t(4) << 20;

/// `values` as a new buffer; none for none.
template <typename T>
GpuTask sendArray(const char* label, const std::vector<T>& values, std::shared_ptr<gpu::Buffer>& out) {
  const auto bytes = gpu::bytesOf(std::span<const T>(values));
  if (bytes.empty()) co_return;
  auto made = std::make_shared<gpu::Buffer>(label, bytes.size(), gpu::BufferUse::kDynamic, gpu::Undefined{});
  for (const Chunk& part : chunksOf(bytes.size())) {
    made->update(part.offset, bytes.subspan(part.offset, part.bytes));
    co_yield submitted(Stage::kUpload, double(part.bytes));
  }
  out = std::move(made);
}

/// `values` in the old buffer where it is nobody else's and of the right size, else in a new one.
template <typename T>
GpuTask rewrite(const char* label, std::shared_ptr<gpu::Buffer> old, const std::vector<T>& values,
                std::shared_ptr<gpu::Buffer>& out) {
  const auto bytes = gpu::bytesOf(std::span<const T>(values));
  if (old == nullptr || old.use_count() > 1 || old->size() != bytes.size()) {
    co_await sendArray(label, values, out);
    co_return;
  }
  glInvalidateBufferData(old->id());
  for (const Chunk& part : chunksOf(bytes.size())) {
    old->update(part.offset, bytes.subspan(part.offset, part.bytes));
    co_yield submitted(Stage::kUpload, double(part.bytes));
  }
  out = std::move(old);
}

bool sameTriangles(const Mesh& a, const Mesh& b) {
  return a.positions.size() == b.positions.size() && a.triangles == b.triangles;
}

struct TexelUpload {
  GLenum storage, layout, type;
};

TexelUpload uploadOf(TexelFormat format) {
  switch (format) {
    case TexelFormat::kRgb8Srgb:
      return {GL_SRGB8_ALPHA8, GL_RGB, GL_UNSIGNED_BYTE};
    case TexelFormat::kRgb16F:
      return {GL_RGBA16F, GL_RGB, GL_HALF_FLOAT};
    case TexelFormat::kRgba8Srgb:
      return {GL_SRGB8_ALPHA8, GL_RGBA, GL_UNSIGNED_BYTE};
    case TexelFormat::kRgb8:
      return {GL_RGBA8, GL_RGB, GL_UNSIGNED_BYTE};
    case TexelFormat::kRgb32F:
      break;
  }
  return {GL_RGBA32F, GL_RGB, GL_FLOAT};
}

template <typename Map>
void dropExpired(Map& map) {
  std::erase_if(map, [](const auto& entry) { return entry.second.expired(); });
}

struct MeshUse {
  std::string user;
  MeshPtr mesh;
};

std::vector<MeshUse> meshUses(const Scene& scene) {
  std::vector<MeshUse> uses;
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled) uses.push_back({"light/" + name, light->mesh});
  }
  for (const auto& [name, surface] : scene.surfaces) uses.push_back({"surface/" + name, surface->mesh});
  return uses;
}

}  // namespace

GpuTask SceneCache::uploadMesh(const MeshPtr& mesh, GpuMeshPtr previous, GpuMeshPtr& out) {
  if (const auto found = meshes_.find(mesh.get()); found != meshes_.end()) {
    if ((out = found->second.lock()) != nullptr) co_return;
  }
  auto made = std::make_shared<GpuMesh>();
  made->source = mesh;
  made->triangleCount = std::uint32_t(mesh->triangles.size());
  if (previous != nullptr && sameTriangles(*previous->source, *mesh)) {
    GpuMesh old = *previous;
    previous.reset();  // the last but one owner of the arrays, unless another light or session has the mesh too
    made->triangles = old.triangles;
    co_await rewrite("positions", std::move(old.positions), mesh->positions, made->positions);
    co_await rewrite("normals", std::move(old.normals), mesh->normals, made->normals);
    made->uvs = old.uvs;
    if (old.source->uvs != mesh->uvs) co_await sendArray("uvs", mesh->uvs, made->uvs);
    made->directions = old.directions;
    if (old.source->directions != mesh->directions)
      co_await sendArray("directions", mesh->directions, made->directions);
  } else {
    co_await sendArray("positions", mesh->positions, made->positions);
    co_await sendArray("normals", mesh->normals, made->normals);
    co_await sendArray("uvs", mesh->uvs, made->uvs);
    co_await sendArray("directions", mesh->directions, made->directions);
    co_await sendArray("triangles", mesh->triangles, made->triangles);
  }
  made->positionTexels = std::make_shared<gpu::BufferTexture>("positions", *made->positions, gpu::BufferTexel::kVec3);
  made->triangleTexels = std::make_shared<gpu::BufferTexture>("triangles", *made->triangles, gpu::BufferTexel::kUvec3);
  if (!mesh->merged.empty()) {
    co_await sendArray("merged triangles", mesh->merged, made->merged);
    made->mergedTexels = std::make_shared<gpu::BufferTexture>("merged", *made->merged, gpu::BufferTexel::kUvec3);
  }
  meshes_[mesh.get()] = made;
  out = std::move(made);
}

GpuTask SceneCache::uploadTexture(const TexturePtr& texture, SceneResources& resources) {
  if (const auto found = textures_.find(texture.get()); found != textures_.end()) {
    if (GpuTexturePtr shared = found->second.lock()) {
      resources.textures[texture] = shared;
      co_return;
    }
  }
  const TexelUpload format = uploadOf(texture->format);
  const glm::ivec2 size(texture->width, texture->height);
  auto made = std::make_shared<gpu::Texture>(
      gpu::Texture::make2d("texture", size, format.storage, gpu::Sampling::kMipmapRepeat, gpu::mipLevels(size)));
  const std::size_t rowBytes = std::size_t(size.x) * texelBytes(texture->format);
  const int rowsAtOnce = int(std::max<std::size_t>(1, kUploadPieceBytes / rowBytes));
  for (int row = 0; row < size.y; row += rowsAtOnce) {
    const int rows = std::min(rowsAtOnce, size.y - row);
    made->uploadRows(row, rows, format.layout, format.type, texture->texels.data() + std::size_t(row) * rowBytes);
    co_yield submitted(Stage::kUpload, double(rows) * double(rowBytes));
  }
  made->generateMipmaps();
  co_yield submitted(Stage::kUpload, 0.0);
  textures_[texture.get()] = made;
  resources.textures[texture] = made;
}

GpuTask SceneCache::uploadLightTextures(const Scene& scene, SceneResources& resources) {
  std::map<TexturePtr, GpuLightTexturePtr> used;
  for (const auto& [name, light] : scene.lights) {
    const TexturePtr& texture = light->texture;
    if (!light->enabled || texture == nullptr || used.contains(texture)) continue;
    GpuLightTexturePtr known = lightTextures_[texture.get()].lock();
    if (known == nullptr) {
      auto made = std::make_shared<GpuLightTexture>();
      co_await uploadLightTexture(texture, *made);
      known = made;
      lightTextures_[texture.get()] = known;
    }
    used[texture] = known;
  }
  resources.lightTextures = std::move(used);
  dropExpired(lightTextures_);
}

GpuTask SceneCache::uploadMeshes(const Scene& scene, SceneResources& resources) {
  const std::vector<MeshUse> uses = meshUses(scene);
  std::map<MeshPtr, GpuMeshPtr> used;
  std::map<std::string, MeshPtr> meshOf;
  for (const MeshUse& use : uses) {
    meshOf[use.user] = use.mesh;
    if (const auto known = resources.meshes.find(use.mesh); known != resources.meshes.end()) used.insert(*known);
  }
  for (const MeshUse& use : uses) {
    if (used.contains(use.mesh)) continue;
    GpuMeshPtr previous;
    if (const auto before = resources.meshOf.find(use.user); before != resources.meshOf.end()) {
      // Taken out of the session's own map, so that use_count tells whether anybody else has it.
      if (auto node = resources.meshes.extract(before->second); !node.empty()) previous = std::move(node.mapped());
    }
    co_await uploadMesh(use.mesh, std::move(previous), used[use.mesh]);
  }
  resources.meshes = std::move(used);
  resources.meshOf = std::move(meshOf);
  dropExpired(meshes_);
}

GpuTask SceneCache::upload(const Scene& scene, SceneResources& resources) {
  co_await uploadMeshes(scene, resources);
  co_await uploadLightTextures(scene, resources);
  std::map<TexturePtr, GpuTexturePtr> textures;
  const bool glossy = showsGloss(scene);
  for (const auto& [name, surface] : scene.surfaces) {
    const std::array worn = {surface->albedoTexture, surface->normalTexture, glossy ? surface->glossTexture : nullptr};
    for (const TexturePtr& texture : worn) {
      if (texture == nullptr || textures.contains(texture)) continue;
      if (!resources.textures.contains(texture)) co_await uploadTexture(texture, resources);
      textures[texture] = resources.textures[texture];
    }
  }
  resources.textures = std::move(textures);
  dropExpired(textures_);
}

}  // namespace lpv
