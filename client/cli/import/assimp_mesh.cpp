#include "import/assimp_mesh.h"

#include <utility>

namespace lpv::cli {
namespace {

template <typename T>
void appendAttribute(std::vector<T>& to, std::size_t vertices, const std::vector<T>& from) {
  if (to.size() != vertices || from.empty()) {
    to.clear();
    return;
  }
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

glm::dvec3 vectorFrom(const aiVector3D& v) { return {v.x, v.y, v.z}; }

glm::dmat4 matrixFrom(const aiMatrix4x4& m) {  // Assimp's rows are glm's columns transposed
  return {{m.a1, m.b1, m.c1, m.d1}, {m.a2, m.b2, m.c2, m.d2}, {m.a3, m.b3, m.c3, m.d3}, {m.a4, m.b4, m.c4, m.d4}};
}

Expected<Mesh> meshFrom(const aiMesh& mesh, unsigned uvChannel) {
  Mesh out;
  const bool uvs = uvChannel < AI_MAX_NUMBER_OF_TEXTURECOORDS && mesh.HasTextureCoords(uvChannel);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    out.positions.emplace_back(vectorFrom(mesh.mVertices[i]));
    if (mesh.HasNormals()) out.normals.emplace_back(vectorFrom(mesh.mNormals[i]));
    if (uvs) out.uvs.emplace_back(mesh.mTextureCoords[uvChannel][i].x, mesh.mTextureCoords[uvChannel][i].y);
  }
  for (unsigned i = 0; i < mesh.mNumFaces; ++i) {
    const aiFace& face = mesh.mFaces[i];
    if (face.mNumIndices == 3) out.triangles.emplace_back(face.mIndices[0], face.mIndices[1], face.mIndices[2]);
  }
  if (Status status = finishMesh(out); !status.ok()) return status;
  return out;
}

Expected<Mesh> baked(Mesh mesh, const glm::dmat4& matrix) {
  const glm::dmat3 linear(matrix);
  const glm::dmat3 normalMatrix = glm::determinant(linear) == 0.0 ? linear : glm::transpose(glm::inverse(linear));
  for (glm::vec3& p : mesh.positions) p = glm::vec3(matrix * glm::dvec4(p, 1.0));
  for (glm::vec3& n : mesh.normals) n = glm::vec3(normalMatrix * glm::dvec3(n));
  if (glm::determinant(linear) < 0.0) {
    for (glm::uvec3& t : mesh.triangles) std::swap(t.y, t.z);
  }
  if (Status status = finishMesh(mesh); !status.ok()) return status;
  return mesh;
}

void append(Mesh& mesh, const Mesh& other) {
  const std::size_t vertices = mesh.positions.size();
  if (vertices == 0) {
    mesh = other;
    return;
  }
  appendAttribute(mesh.normals, vertices, other.normals);
  appendAttribute(mesh.uvs, vertices, other.uvs);
  mesh.positions.insert(mesh.positions.end(), other.positions.begin(), other.positions.end());
  for (const glm::uvec3& t : other.triangles) mesh.triangles.push_back(t + glm::uvec3(vertices));
  mesh.bounds.add(other.bounds);
}

}  // namespace lpv::cli
