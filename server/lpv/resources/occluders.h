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
#include "lpv/resources/placed_trees.h"
#include "scene/haze.h"
#include "scene/occluders.h"

namespace lpv {

/// The BVHs as shaders/visibility/occluders.glsl reads them: the haze, the nodes over instances and over subtrees of
/// those that are placed in one space (scene/placed_trees.h), the instances, then per mesh or placed surface its nodes
/// and triangles, with texture coordinates where alpha varies over an instance or reflections show its picture, then
/// maps of alpha.
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
  /// Of a mesh in its own space.
  struct Place {
    StoredTree stored;
    float reach = 0.0F;  ///< the largest coordinate of the mesh's box
  };
  /// What is kept while the scene's meshes and maps are among them.
  struct Contents {
    std::map<MeshPtr, TriangleBvhPtr> meshes;  ///< in their own spaces
    std::set<MeshPtr> withUvs;  ///< of these
    PlacedObjects placed;
    MadeTrees trees;  ///< of these
    std::set<AlphaMapPtr> maps;
  };
  struct Inputs {
    std::vector<Occluder> occluders;
    Haze haze;
    Grid grid;

    bool operator==(const Inputs&) const = default;
  };

  static Contents contentsOf(const Inputs& inputs, const CommonSpace& space);
  bool has(const Inputs& inputs, const CommonSpace& space, const PlacedObjects& placed) const;
  bool hasMesh(const Occluder& occluder) const;
  GpuTask store(Contents contents, std::size_t top);
  void storeTop(const Inputs& inputs, const CommonSpace& space);

  std::map<MeshPtr, Place> meshes_;
  GpuPlacedTrees placed_;
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
