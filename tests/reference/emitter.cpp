#include "reference/emitter.h"

#include <utility>

#include "reference/sh.h"

namespace lpv::reference {

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
                    bool twoSided) {
  const std::vector<SnappedTriangle> snapped = snapMesh(grid, worldFromObject, mesh);
  const bool mirrored = glm::determinant(glm::dmat3(worldFromObject)) < 0.0;
  Emitters out;
  for (std::size_t i = 0; i < snapped.size(); ++i) {
    Emitter e;
    e.snapped = snapped[i];
    e.radiance = radiance;
    e.twoSided = twoSided;
    for (int k = 0; k < 3; ++k) {
      const glm::dvec4 object(glm::dvec3(mesh.positions[mesh.triangles[i][k]]), 1.0);
      e.corners[std::size_t(k)] = glm::dvec3(worldFromObject * object);
    }
    if (mirrored) std::swap(e.corners[1], e.corners[2]);
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
  return emittersOf(grid, *light.mesh, light.transform.worldFromObject(), radianceOf(light), light.twoSided);
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
  for (const Emitter& e : emitters) sum += e.radiance * (pi() * e.area() * (e.twoSided ? 2.0 : 1.0));
  return sum;
}

}  // namespace lpv::reference
