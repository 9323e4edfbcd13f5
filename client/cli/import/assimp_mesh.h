#pragma once
// Assimp's meshes and matrices as ours.

#include <assimp/matrix4x4.h>
#include <assimp/mesh.h>
#include <assimp/vector3.h>

#include <glm/glm.hpp>

#include "scene/mesh.h"

namespace lpv::cli {

glm::dvec3 vectorFrom(const aiVector3D& v);
glm::dmat4 matrixFrom(const aiMatrix4x4& m);

/// Triangles, normals and the given uv channel (where the mesh has it), checked by finishMesh.
Expected<Mesh> meshFrom(const aiMesh& mesh, unsigned uvChannel);

/// The mesh under a matrix that may shear. A mirroring one turns the winding, so that the outer side stays outside.
Expected<Mesh> baked(Mesh mesh, const glm::dmat4& matrix);

/// Appends `other`'s triangles; attributes that only one of the two has are dropped.
void append(Mesh& mesh, const Mesh& other);

}  // namespace lpv::cli
