#include "reference/emitter.h"

#include <algorithm>
#include <memory>
#include <utility>

#include "reference/emission.h"
#include "reference/sh.h"

namespace lpv::reference {
namespace {

/// The corners' values mixed by b; exactly their value where all three are equal, however far outside b lies.
template <typename Value>
Value mix(const std::array<Value, 3>& values, const glm::dvec3& b) {
  return values[0] + b.y * (values[1] - values[0]) + b.z * (values[2] - values[0]);
}

Emitter emitterOf(const Mesh& mesh, std::uint32_t triangle, const glm::dmat4& worldFromObject) {
  Emitter e;
  e.triangle = triangle;
  e.swapped = glm::determinant(glm::dmat3(worldFromObject)) < 0.0;
  glm::uvec3 vertices = mesh.triangles[triangle];
  if (e.swapped) std::swap(vertices.y, vertices.z);
  for (std::size_t k = 0; k < 3; ++k) {
    const std::uint32_t vertex = vertices[int(k)];
    e.corners[k] = glm::dvec3(worldFromObject * glm::dvec4(glm::dvec3(mesh.positions[vertex]), 1.0));
    if (!mesh.uvs.empty()) e.uvs[k] = glm::dvec2(mesh.uvs[vertex]);
  }
  if (mesh.directions.empty() || e.area() == 0.0) return e;
  e.directions.emplace();
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::dvec3 world = glm::dmat3(worldFromObject) * glm::dvec3(mesh.directions[vertices[int(k)]]);
    const double length = glm::length(world);
    (*e.directions)[k] = length > 0.0 ? world / length : e.normal();
  }
  return e;
}

bool isThin(const Grid& grid, const Mesh& mesh, const glm::dmat4& worldFromObject) {
  std::array<double, 3> edges{};
  for (int k = 0; k < 3; ++k)
    edges[std::size_t(k)] = mesh.bounds.extent()[k] * glm::length(glm::dvec3(worldFromObject[k])) / grid.cell;
  std::sort(edges.begin(), edges.end());
  return edges[1] < kThinLight;
}

}  // namespace

glm::dvec3 unitOr(const glm::dvec3& v, const glm::dvec3& fallback) {
  const double length = glm::length(v);
  return length > kZeroDirection ? v / length : fallback;
}

glm::dvec3 Emitter::positionAt(const glm::dvec3& b) const { return mix(corners, b); }

glm::dvec2 Emitter::uvAt(const glm::dvec3& b) const { return mix(uvs, b); }

glm::dvec3 Emitter::directionAt(const glm::dvec3& b) const {
  if (!directions) return normal();
  const glm::dvec3 mixed = mix(*directions, b);
  return glm::length(mixed) > kZeroDirection ? glm::normalize(mixed) : normal();
}

glm::dmat4 worldFromObject(const Transform& transform) {
  const glm::dquat& q = transform.rotation;
  const glm::dvec3 v(q.x, q.y, q.z);
  glm::dmat4 m(1.0);
  for (int k = 0; k < 3; ++k) {
    glm::dvec3 axis(0.0);
    axis[k] = transform.scale[k];
    const glm::dvec3 turned = axis + 2.0 * glm::cross(v, glm::cross(v, axis) + q.w * axis);
    m[k] = glm::dvec4(turned, 0.0);
  }
  m[3] = glm::dvec4(transform.translation, 1.0);
  return m;
}

Emitters emittersOf(const Grid& grid, const Mesh& mesh, const glm::dmat4& worldFromObject, const glm::dvec3& radiance,
                    bool twoSided, const MipChainPtr& texture) {
  const std::vector<SnappedTriangle> snapped = snapMesh(grid, worldFromObject, mesh);
  Emitters out;
  for (std::size_t i = 0; i < snapped.size(); ++i) {
    Emitter e = emitterOf(mesh, std::uint32_t(i), worldFromObject);
    e.snapped = snapped[i];
    if (e.swapped) std::swap(e.snapped.corners[1], e.snapped.corners[2]);
    e.radiance = radiance;
    e.twoSided = twoSided;
    e.thin = isThin(grid, mesh, worldFromObject);
    if (!mesh.uvs.empty()) e.texture = texture;
    if (e.area() > 0.0) {
      out.triangles.push_back(e);
    } else {
      ++out.degenerate;
    }
  }
  return out;
}

Emitters emittersOf(const Grid& grid, const Light& light) {
  if (!light.enabled) return {};
  const auto texture = light.texture ? std::make_shared<const MipChain>(mipChainOf(*light.texture)) : nullptr;
  return emittersOf(grid, *light.mesh, light.transform.worldFromObject(), radianceOf(light), light.twoSided, texture);
}

Emitters emittersOf(const Scene& scene) {
  Emitters all;
  for (const auto& [name, light] : scene.lights) {
    const Emitters one = emittersOf(scene.grid, *light);
    all.triangles.insert(all.triangles.end(), one.triangles.begin(), one.triangles.end());
    all.degenerate += one.degenerate;
  }
  return all;
}

glm::dvec3 radianceOf(const Light& light) {
  if (!light.power) return light.radiance;
  const glm::dmat4 m = worldFromObject(light.transform);
  double area = 0.0;
  for (const glm::uvec3& t : light.mesh->triangles) {
    std::array<glm::dvec3, 3> p;
    for (int k = 0; k < 3; ++k) {
      p[std::size_t(k)] = glm::dvec3(m * glm::dvec4(glm::dvec3(light.mesh->positions[t[k]]), 1.0));
    }
    area += 0.5 * glm::length(glm::cross(p[1] - p[0], p[2] - p[0]));
  }
  const double sides = light.twoSided ? 2.0 : 1.0;
  return area > 0.0 ? *light.power / (pi() * area * sides) : glm::dvec3(0.0);
}

glm::dvec3 powerOf(const std::vector<Emitter>& emitters) {
  glm::dvec3 sum(0.0);
  for (const Emitter& e : emitters) sum += pi() * (e.twoSided ? 2.0 : 1.0) * radianceIntegral(e, wholeTriangle());
  return sum;
}

}  // namespace lpv::reference
