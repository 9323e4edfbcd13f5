#pragma once
// Meshes and textures on the GPU: uploaded once, shared by all sessions that hold the same object.

#include <cstdint>
#include <map>
#include <memory>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "gpu/texture.h"
#include "lpv/pacing/gpu_task.h"
#include "lpv/resources/light_texture.h"
#include "scene/scene.h"

namespace lpv {

/// A mesh's arrays, as storage for voxelization and as vertex and index buffers for drawing. Arrays are shared between
/// meshes that differ only in the others (a deforming mesh keeps its triangles).
struct GpuMesh {
  MeshPtr source;
  std::shared_ptr<gpu::Buffer> positions;  ///< float x 3 per vertex, object space
  std::shared_ptr<gpu::Buffer> normals;    ///< float x 3 per vertex, or null
  std::shared_ptr<gpu::Buffer> uvs;        ///< float x 2 per vertex, or null
  std::shared_ptr<gpu::Buffer> directions; ///< float x 3 per vertex, object space, or null
  std::shared_ptr<gpu::Buffer> triangles;  ///< uint x 3 per triangle
  std::shared_ptr<gpu::Buffer> merged;     ///< the same of Mesh::merged, or null
  std::shared_ptr<gpu::BufferTexture> positionTexels, triangleTexels, mergedTexels;  ///< as voxelization reads them
  std::uint32_t triangleCount = 0;
};
using GpuMeshPtr = std::shared_ptr<const GpuMesh>;
using GpuTexturePtr = std::shared_ptr<const gpu::Texture>;
using GpuLightTexturePtr = std::shared_ptr<const GpuLightTexture>;

/// What one session's scene uses, by the objects' identity; keeps them on the GPU.
struct SceneResources {
  std::map<MeshPtr, GpuMeshPtr> meshes;
  std::map<TexturePtr, GpuTexturePtr> textures;
  std::map<TexturePtr, GpuLightTexturePtr> lightTextures;
  std::map<std::string, MeshPtr> meshOf;  ///< "light/NAME" or "surface/NAME": the mesh it had in the last tick
};

class SceneCache {
 public:
  /// Brings everything `scene` needs onto the GPU and lets go of what it does not need any more. A light or surface
  /// whose mesh was replaced by one with the same triangles (a deforming mesh) only sends vertices, into the old
  /// buffers where nobody else uses them.
  GpuTask upload(const Scene& scene, SceneResources& resources);

 private:
  GpuTask uploadMesh(const MeshPtr& mesh, GpuMeshPtr previous, GpuMeshPtr& out);
  GpuTask uploadMeshes(const Scene& scene, SceneResources& resources);
  GpuTask uploadTexture(const TexturePtr& texture, SceneResources& resources);
  GpuTask uploadLightTextures(const Scene& scene, SceneResources& resources);

  std::map<const Mesh*, std::weak_ptr<const GpuMesh>> meshes_;
  std::map<const Texture*, std::weak_ptr<const gpu::Texture>> textures_;
  std::map<const Texture*, std::weak_ptr<const GpuLightTexture>> lightTextures_;
};

}  // namespace lpv
