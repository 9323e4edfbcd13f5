#pragma once
// Procedural meshes: the five of the paper's table but Lucy, and what tests need besides. All are finished
// (finishMesh), in metres about the origin, counter-clockwise seen from outside.

#include <cstdint>
#include <glm/glm.hpp>

#include "scene/mesh.h"

namespace lpv::reference {

/// 2 triangles, 1 x 1 m in z = 0, front towards +z, with uvs (v = 0 at the top edge).
MeshPtr quad();
/// The same square in 2 n^2 triangles: injection must not see the difference.
MeshPtr quadOf(int n);
/// 6 triangles: base 1 x 1 m at y = -.5, apex at y = .5; closed.
MeshPtr pyramid();
/// 12 triangles: six sides about the x axis, 2 m long, .2 m across, open ends, with vertex normals.
MeshPtr tube();
/// 720 triangles: 24 slices, 16 stacks, radius .5 m, vertices on the sphere, with vertex normals; closed.
MeshPtr sphere();
/// Latitude-longitude sphere of 2 slices (stacks - 1) triangles, radius .5 m.
MeshPtr sphereOf(int slices, int stacks, bool normals = true);
/// A sphere with waves on it and exactly n triangles (even, at least 100), radius .4 .. .6 m; closed.
MeshPtr bumpySphere(std::size_t n);
/// n thin triangles within a 1 m box, 1 m long and `width` m wide, directions from `seed`.
MeshPtr slivers(int n, double width, std::uint32_t seed = 1);
/// 12 triangles, an axis-aligned box; `inward`: its inside is the front (a room).
MeshPtr box(const glm::dvec3& min, const glm::dvec3& max, bool inward = false);

}  // namespace lpv::reference
