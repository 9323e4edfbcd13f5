#include "scene/mesh.h"

#include <cmath>

#include "scene/flat_patches.h"

namespace lpv {
namespace {

bool finite(const glm::vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

Status checkPositions(const std::vector<glm::vec3>& positions) {
  constexpr float kLargest = 1e9F;  // metres: beyond it a float's step is 64 m
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const glm::vec3& p = positions[i];
    if (!finite(p)) {
      return invalid("positions", "positions[" + std::to_string(i) + "] is not finite: (" + std::to_string(p.x) + ", " +
                                      std::to_string(p.y) + ", " + std::to_string(p.z) + ")");
    }
    if (std::abs(p.x) > kLargest || std::abs(p.y) > kLargest || std::abs(p.z) > kLargest) {
      return invalid("positions", "positions[" + std::to_string(i) + "] is beyond 1e9 m");
    }
  }
  return {};
}

Status checkCount(const char* field, std::size_t count, std::size_t vertices) {
  if (count == 0 || count == vertices) return {};
  return invalid(field, std::string(field) + " has " + std::to_string(count) + " entries for " +
                            std::to_string(vertices) + " positions; allowed are none or one each");
}

/// Wrong normals of a file are replaced and not refused, because they only shade. Normals of unit length keep their
/// bits, so that a mesh read back from its own bytes has the same hash.
void repairNormals(Mesh& mesh) {
  constexpr float kUnit = 1e-6F;  // normalising leaves a smaller deviation from 1
  std::vector<glm::vec3> replacement;
  for (std::size_t i = 0; i < mesh.normals.size(); ++i) {
    glm::vec3& n = mesh.normals[i];
    const float length = glm::length(n);
    if (std::isfinite(length) && length > 1e-12F) {
      if (std::abs(length - 1.0F) > kUnit) n /= length;
      continue;
    }
    if (replacement.empty()) replacement = vertexNormals(mesh.positions, mesh.triangles);
    n = replacement[i];
  }
}

}  // namespace

std::size_t Mesh::bytes() const {
  return positions.size() * sizeof(glm::vec3) + normals.size() * sizeof(glm::vec3) + uvs.size() * sizeof(glm::vec2) +
         directions.size() * sizeof(glm::vec3) + (triangles.size() + merged.size()) * sizeof(glm::uvec3);
}

Status finishMesh(Mesh& mesh) {
  const std::size_t vertices = mesh.positions.size();
  if (vertices < 3) {
    return invalid("positions", "positions has " + std::to_string(vertices) + " vertices; a mesh needs at least 3");
  }
  if (mesh.triangles.empty()) return invalid("indices", "indices is empty; a mesh needs at least 1 triangle");
  if (Status s = checkPositions(mesh.positions); !s.ok()) return s;
  if (Status s = checkCount("normals", mesh.normals.size(), vertices); !s.ok()) return s;
  if (Status s = checkCount("uvs", mesh.uvs.size(), vertices); !s.ok()) return s;
  if (Status s = checkCount("directions", mesh.directions.size(), vertices); !s.ok()) return s;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (int corner = 0; corner < 3; ++corner) {
      const std::uint32_t index = mesh.triangles[t][corner];
      if (index < vertices) continue;
      return invalid("indices", "indices of triangle " + std::to_string(t) + " name vertex " + std::to_string(index) +
                                    ", the mesh has vertices 0.." + std::to_string(vertices - 1));
    }
  }
  for (std::size_t i = 0; i < mesh.uvs.size(); ++i) {
    if (std::isfinite(mesh.uvs[i].x) && std::isfinite(mesh.uvs[i].y)) continue;
    return invalid("uvs", "uvs[" + std::to_string(i) + "] is not finite");
  }
  for (std::size_t i = 0; i < mesh.directions.size(); ++i) {
    if (finite(mesh.directions[i])) continue;
    return invalid("directions", "directions[" + std::to_string(i) + "] is not finite");
  }
  repairNormals(mesh);
  mesh.bounds = Bounds();
  for (const glm::vec3& p : mesh.positions) mesh.bounds.add(glm::dvec3(p));
  mesh.area = worldArea(mesh, Transform());
  mesh.merged = flatPatchesMerged(mesh);
  return {};
}

Expected<Mesh> withVertices(const Mesh& mesh, std::vector<glm::vec3> positions, std::vector<glm::vec3> normals) {
  if (positions.size() != mesh.positions.size()) {
    return invalid("positions", "positions has " + std::to_string(positions.size()) + " vertices, the mesh has " +
                                    std::to_string(mesh.positions.size()) +
                                    "; upload another mesh to change their number");
  }
  Mesh out;
  out.positions = std::move(positions);
  out.triangles = mesh.triangles;
  out.uvs = mesh.uvs;
  out.directions = mesh.directions;
  out.normals = std::move(normals);
  if (Status s = checkPositions(out.positions); !s.ok()) return s;
  if (out.normals.empty() && !mesh.normals.empty()) out.normals = vertexNormals(out.positions, out.triangles);
  if (Status s = checkCount("normals", out.normals.size(), out.positions.size()); !s.ok()) return s;
  repairNormals(out);
  for (const glm::vec3& p : out.positions) out.bounds.add(glm::dvec3(p));
  out.area = worldArea(out, Transform());
  out.merged = flatPatchesMerged(out);
  return out;
}

std::vector<glm::vec3> vertexNormals(const std::vector<glm::vec3>& positions,
                                     const std::vector<glm::uvec3>& triangles) {
  std::vector<glm::dvec3> sums(positions.size(), glm::dvec3(0.0));
  for (const glm::uvec3& t : triangles) {
    const glm::dvec3 a(positions[t.x]);
    const glm::dvec3 n = glm::cross(glm::dvec3(positions[t.y]) - a, glm::dvec3(positions[t.z]) - a);
    for (int corner = 0; corner < 3; ++corner) sums[t[corner]] += n;
  }
  std::vector<glm::vec3> normals(positions.size());
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const double length = glm::length(sums[i]);
    normals[i] = length > 0.0 ? glm::vec3(sums[i] / length) : glm::vec3(0.0F, 0.0F, 1.0F);
  }
  return normals;
}

double worldArea(const Mesh& mesh, const Transform& transform) {
  const glm::dmat3 linear(transform.worldFromObject());
  double twice = 0.0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    const glm::dvec3 ab = linear * (glm::dvec3(mesh.positions[t.y]) - a);
    const glm::dvec3 ac = linear * (glm::dvec3(mesh.positions[t.z]) - a);
    twice += glm::length(glm::cross(ab, ac));
  }
  return 0.5 * twice;
}

std::size_t degenerateTriangles(const Mesh& mesh) {
  std::size_t count = 0;
  for (const glm::uvec3& t : mesh.triangles) {
    const glm::dvec3 a(mesh.positions[t.x]);
    const glm::dvec3 n = glm::cross(glm::dvec3(mesh.positions[t.y]) - a, glm::dvec3(mesh.positions[t.z]) - a);
    if (n == glm::dvec3(0.0)) ++count;
  }
  return count;
}

}  // namespace lpv
