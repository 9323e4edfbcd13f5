#pragma once
// A light's triangles in a tree, as receivers look at them without a grid (MATHS.md 3c): from afar as VPLs, from near
// by the closed form.

#include <cstddef>
#include <glm/glm.hpp>
#include <memory>
#include <vector>

#include "scene/mesh.h"

namespace lpv {

/// Lights of more triangles are looked at through the VPLs of their cells instead: memory, and time to make the tree.
inline constexpr std::size_t kMostTreeTriangles = 262'144;

/// In a space of its own: the mesh scaled along its axes, and then so that its longest edge is 1. Immutable.
struct EmitterTree {
  /// `shape`: of the scale along the mesh's axes; negative ones mirror, and the front stays the front. None is 0.
  EmitterTree(const Mesh& mesh, const glm::dvec3& shape);

  glm::dvec3 shape{1.0};
  double unit = 1.0;              ///< tree space over object space scaled by `shape`
  std::size_t entries = 0;        ///< of the tree
  std::vector<glm::vec4>
      texels;  ///< as shaders/transport/vpls.glsl has a tree's entries, then the corners of triangles
};
using EmitterTreePtr = std::shared_ptr<const EmitterTree>;

/// How a light's mesh is placed: its tree, and what leads from grid space to the tree's.
struct PlacedEmitterTree {
  EmitterTreePtr tree;
  glm::dmat4 treeFromGrid{1.0};  ///< a rotation, a translation and one scale
};

/// Of an affine map without shear. The tree is made at the first call for a mesh and shape, some 100 ms for 100,000
/// triangles, and kept while the mesh is there. Thread-safe.
PlacedEmitterTree emitterTreeOf(const MeshPtr& mesh, const glm::dmat4& gridFromObject);

/// The same at once, where the tree is there already; else none.
PlacedEmitterTree knownEmitterTreeOf(const MeshPtr& mesh, const glm::dmat4& gridFromObject);

}  // namespace lpv
