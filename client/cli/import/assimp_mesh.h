#pragma once
// Converts Assimp's meshes and matrices.

#include <assimp/matrix4x4.h>
#include <assimp/mesh.h>
#include <assimp/vector3.h>

#include <glm/glm.hpp>

#include "scene/mesh.h"

namespace lpv::cli {

glm::dvec3 vectorFrom(const aiVector3D& v);
glm::dmat4 matrixFrom(const aiMatrix4x4& m);

/// Triangles, normals and the given uv channel (if the mesh has it), checked by finishMesh.
Expected<Mesh> meshFrom(const aiMesh& mesh, unsigned uvChannel);

/// The mesh transformed by a matrix that may shear. A mirroring matrix reverses the winding, so that front stays front.
Expected<Mesh> baked(Mesh mesh, const glm::dmat4& matrix);

/// Appends `other`'s triangles. Attributes that only one of the two meshes has are dropped.
void append(Mesh& mesh, const Mesh& other);

}  // namespace lpv::cli
