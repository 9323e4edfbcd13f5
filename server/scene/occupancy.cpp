#include "scene/occupancy.h"

#include <algorithm>
#include <cmath>

namespace lpv {
namespace {

/// Approximate limit of sample points, which bounds the time for any upload. Scenes that would need more are sampled
/// more sparsely.
constexpr double kMaxPoints = 4e6;

}  // namespace

Occupancy::Occupancy(const Scene& scene, int longest) : bounds_(contentBounds(scene)) {
  const glm::dvec3 extent = bounds_.extent();
  cell_ = std::max({extent.x, extent.y, extent.z, 1e-9}) / longest;
  dims_ = glm::max(glm::ivec3(glm::ceil(extent / cell_)), glm::ivec3(1));
  cells_.assign(std::size_t(dims_.x) * std::size_t(dims_.y) * std::size_t(dims_.z), false);
  double points = 0.0;
  forEachTriangle(scene, [&](const auto& corners) { points += 0.5 * std::pow(stepsAcross(corners) + 1.5, 2.0); });
  const double closeness = std::min(1.0, std::sqrt(kMaxPoints / std::max(points, 1.0)));
  forEachTriangle(scene, [&](const auto& corners) {
    fill(corners, std::max(1, int(std::ceil(closeness * stepsAcross(corners)))));
  });
}

double Occupancy::freeDistance(const glm::dvec3& eye, const glm::dvec3& direction) const {
  for (double t = 0.0;; t += cell_ * 0.5) {
    const glm::ivec3 c = cellOf(eye + direction * t);
    if (!inside(c) || at(c)) return t;
  }
}

bool Occupancy::isBlocked(const glm::dvec3& eye, const glm::dvec3& direction, double from) const {
  for (double t = from;; t += cell_ * 0.5) {
    const glm::ivec3 c = cellOf(eye + direction * t);
    if (!inside(c)) return false;
    if (at(c)) return true;
  }
}

template <typename Visit>
void Occupancy::forEachTriangle(const Scene& scene, Visit visit) {
  const auto visitMesh = [&visit](const Mesh& mesh, const glm::dmat4& worldFromObject) {
    for (const glm::uvec3& t : mesh.triangles) {
      glm::dvec3 corners[3];
      for (int i = 0; i < 3; ++i) {
        corners[i] = glm::dvec3(worldFromObject * glm::dvec4(glm::dvec3(mesh.positions[t[i]]), 1.0));
      }
      visit(corners);
    }
  };
  for (const auto& [name, surface] : scene.surfaces) visitMesh(*surface->mesh, surface->transform.worldFromObject());
  for (const auto& [name, light] : scene.lights) {
    if (light->enabled && !light->distant) visitMesh(*light->mesh, light->transform.worldFromObject());
  }
}

/// Steps along a triangle's edges that leave its points no more than half a cell apart.
int Occupancy::stepsAcross(const glm::dvec3 (&v)[3]) const {
  const double longest = std::max({glm::distance(v[0], v[1]), glm::distance(v[1], v[2]), glm::distance(v[2], v[0])});
  return std::max(1, int(std::ceil(2.0 * longest / cell_)));
}

void Occupancy::fill(const glm::dvec3 (&v)[3], int steps) {
  for (int i = 0; i <= steps; ++i) {
    for (int j = 0; j <= steps - i; ++j) {
      const glm::dvec3 p = v[0] + (v[1] - v[0]) * (double(i) / steps) + (v[2] - v[0]) * (double(j) / steps);
      cells_[index(glm::clamp(cellOf(p), glm::ivec3(0), dims_ - 1))] = true;
    }
  }
}

}  // namespace lpv
