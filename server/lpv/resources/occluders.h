#pragma once
// What shadow rays can meet, on the GPU (MATHS.md 3d; scene/occluders.h).

#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "gpu/buffer.h"
#include "gpu/buffer_texture.h"
#include "lpv/cached.h"
#include "lpv/pacing/gpu_task.h"
#include "scene/haze.h"
#include "scene/occluders.h"

namespace lpv {

/// The BVH over BVHs as shaders/visibility/occluders.glsl reads it: the haze, the nodes over instances, the instances,
/// then per mesh its nodes and triangles, with texture coordinates where alpha varies over an instance or reflections
/// show its picture, then maps of alpha.
class GpuOccluders {
 public:
  /// Makes what differs from the last scene; `haze` fills a part of it. Trees over new meshes are made on another
  /// thread meanwhile.
  GpuTask update(std::vector<Occluder> occluders, const Grid& grid, Haze haze = {});
  void bind() const;
  /// Changes with what blocks all lights.
  Stamp surfaces() const { return surfaces_.stamp(); }
  /// Changes with all that blocks any light.
  Stamp all() const { return made_.stamp(); }
  /// Whether something there lets light through, or haze takes some of it.
  bool transparent() const { return transparent_; }
  /// Of what does not block all lights, in the grid's space; empty without any.
  const Bounds& boxOfLights() const { return boxOfLights_; }
  std::size_t bytes() const { return texels_.size(); }

 private:
  /// Where a mesh is in the buffer, in texels.
  struct Place {
    std::uint32_t nodes = 0;
    std::uint32_t triangles = 0;  ///< and one past the last node
    float reach = 0.0F;           ///< the largest coordinate of the mesh's box
    std::uint32_t uvs = 0;        ///< 0: none
  };
  /// What is kept while the scene's meshes and maps are among them.
  struct Contents {
    std::map<MeshPtr, TriangleBvhPtr> meshes;
    std::set<MeshPtr> withUvs;
    std::set<AlphaMapPtr> maps;
  };
  struct Inputs {
    std::vector<Occluder> occluders;
    Haze haze;
    Grid grid;

    bool operator==(const Inputs&) const = default;
  };

  static Contents contentsOf(const std::vector<Occluder>& occluders);
  bool has(const Occluder& occluder) const;
  GpuTask store(Contents contents, std::size_t top);
  GpuTask storeMesh(const MeshPtr& mesh, const TriangleBvh& bvh, bool withUvs, std::size_t& at, Place& place);
  void storeTop(const Inputs& inputs);

  std::map<MeshPtr, Place> meshes_;
  std::map<AlphaMapPtr, std::uint32_t> maps_;  ///< first texel
  std::size_t room_ = 0;  ///< texels before the first mesh, for what is above
  gpu::Buffer texels_;
  gpu::BufferTexture view_;
  bool transparent_ = false;
  Bounds boxOfLights_;
  Cached<Inputs> made_;
  Cached<Inputs> surfaces_;  ///< of these, what blocks all lights
};

}  // namespace lpv
