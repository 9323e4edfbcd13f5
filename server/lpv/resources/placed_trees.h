#pragma once
// Surfaces that shadow rays meet in one space, on the GPU (scene/placed_trees.h): a part of the buffer of GpuOccluders.

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "lpv/resources/stored_tree.h"
#include "scene/placed_trees.h"

namespace lpv {

/// A member of the common space.
struct PlacedObject {
  MeshPtr mesh;
  glm::dmat4 spaceFromObject{1.0};
  bool withUvs = false;  ///< reflections show a picture of it

  bool operator==(const PlacedObject&) const = default;
};
using PlacedObjects = std::vector<PlacedObject>;

/// What is made of an object on any thread.
struct MadeTree {
  TriangleBvhPtr bvh;  ///< of its mesh
  PlacedTree placed;
};
using MadeTrees = std::vector<MadeTree>;

class GpuPlacedTrees {
 public:
  /// Takes some time. Thread-safe.
  static MadeTrees make(const PlacedObjects& objects);
  static std::size_t texelsOf(const PlacedObjects& objects, const MadeTrees& trees);
  /// Of the tree over subtrees of so many objects, at most.
  static std::size_t texelsAbove(std::size_t objects);

  /// Whether each object has a place with its mesh already.
  bool has(const PlacedObjects& objects) const;
  /// Puts the objects' trees at `at`, which is afterwards one past them. Nothing is in the buffer before.
  GpuTask store(gpu::Buffer& buffer, PlacedObjects objects, MadeTrees trees, std::size_t& at);
  /// Puts those anew that stand elsewhere than before; has(objects).
  GpuTask move(gpu::Buffer& buffer, PlacedObjects objects);
  /// Forgets all.
  void clear();

  /// Of the objects last stored or moved.
  const StoredTree& tree(std::size_t object) const { return places_[members_[object]].stored; }
  std::size_t nodesAbove() const { return above_.nodes.size(); }
  std::size_t texelsAbove() const;
  /// Appends the tree over their subtrees, which will be at texel `at`; `instances`: the texel of each object's.
  void appendAbove(std::size_t at, std::span<const std::uint32_t> instances, std::vector<OccluderTexel>& out) const;

 private:
  /// Of the buffer, with what stands there.
  struct Place {
    MeshPtr mesh;
    std::optional<glm::dmat4> spaceFromObject;  ///< nothing while it is put there
    StoredTree stored;
    std::vector<BvhNode> nodes;
  };

  /// Of each object the place with its mesh, each place once; nothing where one has none.
  std::optional<std::vector<std::size_t>> placesOf(const PlacedObjects& objects) const;
  GpuTask put(gpu::Buffer& buffer, PlacedTree tree, const glm::dmat4& spaceFromObject, Place& place);
  void makeAbove();

  std::optional<PlacedObjects> objects_;  ///< those that are in the buffer; nothing while they are put there
  std::vector<Place> places_;
  std::map<MeshPtr, std::vector<std::size_t>> byMesh_;
  std::vector<std::size_t> members_;  ///< the objects' places
  Bvh above_;  ///< over subtrees_
  std::vector<Subtree> subtrees_;  ///< of members_
};

}  // namespace lpv
