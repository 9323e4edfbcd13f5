#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <string>
#include <vector>

#include "base/status.h"
#include "scene/bounds.h"
#include "scene/transform.h"

namespace lpv {

/// SHA-256 of a blob's bytes, lower-case hexadecimal (64 characters).
using BlobHash = std::string;

/// Triangles in object space. Immutable once shared; counter-clockwise seen from the emitting side.
struct Mesh {
  std::vector<glm::vec3> positions;    ///< object space, metres; finite
  std::vector<glm::vec3> normals;      ///< empty, or one per position; for shading only, never for emission
  std::vector<glm::vec2> uvs;          ///< empty, or one per position; (0,0) is the first texel of the first row
  std::vector<glm::vec3> directions;   ///< empty, or one emission direction per position (paper 3.2)
  std::vector<glm::uvec3> triangles;   ///< indices into positions
  /// The same surface for what does not vary over it: flat patches with a convex outline are fans, so that an answer
  /// does not depend on how they were cut up (scene/flat_patches.h); empty where that changes nothing.
  std::vector<glm::uvec3> merged;
  BlobHash hash;                       ///< of the blob this came from; names the content
  /// The blob's bytes if serialising this mesh would give others (repaired normals, another order of fields); else
  /// null.
  std::shared_ptr<const std::string> source;
  Bounds bounds;  ///< of positions
  double area = 0.0;  ///< of one side, object space, m^2

  const std::vector<glm::uvec3>& evenTriangles() const { return merged.empty() ? triangles : merged; }
  std::size_t bytes() const;
};
using MeshPtr = std::shared_ptr<const Mesh>;

/// INVALID_ARGUMENT for an empty mesh, a position that is not finite, an index out of range, or attributes whose
/// count is not that of the positions; the message names index and value. Normals that are not finite or have no
/// length are replaced by the area-weighted mean of their triangles. Fills `merged`, `bounds` and `area`.
Status finishMesh(Mesh& mesh);

/// The same triangles with new vertices (a deforming mesh): positions.size() must match. Normals, where the mesh has
/// them, are recomputed unless given.
Expected<Mesh> withVertices(const Mesh& mesh, std::vector<glm::vec3> positions, std::vector<glm::vec3> normals);

/// Area-weighted vertex normals, unit length; (0,0,1) where every triangle around is degenerate.
std::vector<glm::vec3> vertexNormals(const std::vector<glm::vec3>& positions, const std::vector<glm::uvec3>& triangles);

/// Surface area of one side under `transform`, m^2, in double.
double worldArea(const Mesh& mesh, const Transform& transform);

/// Triangles of zero area: they emit nothing, are skipped and counted, never an error (MATHS.md 2).
std::size_t degenerateTriangles(const Mesh& mesh);

}  // namespace lpv
