#include "default_view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

namespace lpv::cli {
namespace {

constexpr int kCellsOfLongestEdge = 48;
constexpr double kWall = 0.8;          ///< a side is a wall when this share of it is covered
constexpr double kShell = 1.0 / 3.0;   ///< ... by something in the outer part of this depth
constexpr double kRoomFov = 60.0;      ///< degrees, vertical, of the view inside a room
constexpr double kOpenFov = 40.0;      ///< ... through an open side

/// Which cells of a coarse grid over the scene hold a piece of a triangle.
class Occupancy {
 public:
  explicit Occupancy(const ImportedScene& scene) : bounds_(boundsOf(scene)) {
    const glm::dvec3 extent = bounds_.extent();
    cell_ = std::max({extent.x, extent.y, extent.z, 1e-9}) / kCellsOfLongestEdge;
    dims_ = glm::max(glm::ivec3(glm::ceil(extent / cell_)), glm::ivec3(1));
    cells_.assign(std::size_t(dims_.x) * std::size_t(dims_.y) * std::size_t(dims_.z), false);
    for (const Light& light : scene.lights) add(*light.mesh, light.transform.worldFromObject());
    for (const Surface& surface : scene.surfaces) add(*surface.mesh, surface.transform.worldFromObject());
  }

  const Bounds& bounds() const { return bounds_; }
  const glm::ivec3& dims() const { return dims_; }
  double cell() const { return cell_; }
  bool inside(const glm::ivec3& c) const {
    return glm::all(glm::greaterThanEqual(c, glm::ivec3(0))) && glm::all(glm::lessThan(c, dims_));
  }
  bool at(const glm::ivec3& c) const { return cells_[index(c)]; }
  glm::ivec3 cellOf(const glm::dvec3& world) const { return glm::ivec3(glm::floor((world - bounds_.min) / cell_)); }

  /// Distance in metres from `eye` along unit `direction` to the first occupied cell, or out of the grid.
  double freeDistance(const glm::dvec3& eye, const glm::dvec3& direction) const {
    for (double t = 0.0;; t += cell_ * 0.5) {
      const glm::ivec3 c = cellOf(eye + direction * t);
      if (!inside(c) || at(c)) return t;
    }
  }

 private:
  std::size_t index(const glm::ivec3& c) const {
    return (std::size_t(c.z) * std::size_t(dims_.y) + std::size_t(c.y)) * std::size_t(dims_.x) + std::size_t(c.x);
  }

  void add(const Mesh& mesh, const glm::dmat4& worldFromObject) {
    for (const glm::uvec3& t : mesh.triangles) {
      glm::dvec3 corners[3];
      for (int i = 0; i < 3; ++i) {
        corners[i] = glm::dvec3(worldFromObject * glm::dvec4(glm::dvec3(mesh.positions[t[i]]), 1.0));
      }
      addTriangle(corners);
    }
  }

  /// Points no more than half a cell apart.
  void addTriangle(const glm::dvec3 (&v)[3]) {
    const double longest = std::max({glm::distance(v[0], v[1]), glm::distance(v[1], v[2]), glm::distance(v[2], v[0])});
    const int steps = std::max(1, int(std::ceil(2.0 * longest / cell_)));
    for (int i = 0; i <= steps; ++i) {
      for (int j = 0; j <= steps - i; ++j) {
        const glm::dvec3 p = v[0] + (v[1] - v[0]) * (double(i) / steps) + (v[2] - v[0]) * (double(j) / steps);
        cells_[index(glm::clamp(cellOf(p), glm::ivec3(0), dims_ - 1))] = true;
      }
    }
  }

  Bounds bounds_;
  double cell_ = 1.0;
  glm::ivec3 dims_{1};
  std::vector<bool> cells_;
};

/// Share of a side that something in the outer shell covers; `upper`: the side at the axis's maximum.
double coverage(const Occupancy& grid, int axis, bool upper) {
  const glm::ivec3 dims = grid.dims();
  const int u = (axis + 1) % 3;
  const int v = (axis + 2) % 3;
  const int depth = std::max(1, int(dims[axis] * kShell));
  int covered = 0;
  for (int i = 0; i < dims[u]; ++i) {
    for (int j = 0; j < dims[v]; ++j) {
      bool hit = false;
      for (int k = 0; k < depth && !hit; ++k) {
        glm::ivec3 c;
        c[axis] = upper ? dims[axis] - 1 - k : k;
        c[u] = i;
        c[v] = j;
        hit = grid.at(c);
      }
      covered += hit ? 1 : 0;
    }
  }
  return double(covered) / (double(dims[u]) * dims[v]);
}

bool somethingInside(const Occupancy& grid) {
  const glm::ivec3 low = grid.dims() / 5;
  const glm::ivec3 high = grid.dims() - low;
  for (int z = low.z; z < high.z; ++z) {
    for (int y = low.y; y < high.y; ++y) {
      for (int x = low.x; x < high.x; ++x) {
        if (grid.at({x, y, z})) return true;
      }
    }
  }
  return false;
}

Camera withRange(Camera camera, const Bounds& bounds) {
  const double size = glm::length(bounds.extent());
  camera.near = std::max(size * 1e-3, 1e-6);
  camera.far = size * 10.0;
  return camera;
}

/// Through the open side, everything of it in the picture.
Camera throughOpening(const Bounds& bounds, int axis, bool upper, double aspect) {
  const glm::dvec3 half = bounds.extent() * 0.5;
  const double tangent = std::tan(glm::radians(kOpenFov) * 0.5);
  const double distance = 1.05 * std::max(half.y / tangent, half[axis == 0 ? 2 : 0] / (tangent * aspect));
  Camera camera;
  camera.fovDegrees = kOpenFov;
  camera.target = bounds.centre();
  camera.eye = camera.target;
  camera.eye[axis] += (upper ? 1.0 : -1.0) * (half[axis] + distance);
  return withRange(camera, bounds);
}

/// How far and how freely one sees: the mean free distance over the picture, near things counted against it.
double openness(const Occupancy& grid, const Camera& camera, double aspect, double length) {
  constexpr int kAcross = 9;
  constexpr int kDown = 5;
  double sum = 0.0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      const glm::dvec3 ray = camera.rayDirection((i + 0.5) / kAcross, (j + 0.5) / kDown, aspect);
      const double distance = grid.freeDistance(camera.eye, ray);
      sum += distance < 0.12 * length ? -length : std::min(distance, length);
    }
  }
  return sum;
}

Camera insideRoom(const Occupancy& grid, double aspect) {
  const Bounds& bounds = grid.bounds();
  const glm::dvec3 extent = bounds.extent();
  const int along = extent.x > extent.z ? 0 : 2;
  const int across = 2 - along;
  Camera best;
  double bestScore = -std::numeric_limits<double>::infinity();
  for (const double end : {0.04, 0.07, 0.1, 0.15, 0.2, 0.8, 0.85, 0.9, 0.93, 0.96}) {
    for (const double side : {0.2, 0.35, 0.5, 0.65, 0.8}) {
      Camera camera;
      camera.fovDegrees = kRoomFov;
      camera.eye = bounds.min + extent * 0.5;
      camera.eye[along] = bounds.min[along] + extent[along] * end;
      camera.eye[across] = bounds.min[across] + extent[across] * side;
      camera.target = bounds.centre() - glm::dvec3(0.0, extent.y * 0.05, 0.0);
      camera.target[along] = bounds.min[along] + extent[along] * (end < 0.5 ? 1.0 : 0.0);
      const double score = openness(grid, camera, aspect, extent[along]);
      if (score <= bestScore) continue;
      bestScore = score;
      best = camera;
    }
  }
  return withRange(best, bounds);
}

}  // namespace

Camera defaultView(const ImportedScene& scene, double aspect) {
  const Occupancy grid(scene);
  int walls = 0;
  int openAxis = 0;
  bool openUpper = false;
  for (const int axis : {0, 2}) {
    for (const bool upper : {false, true}) {
      if (coverage(grid, axis, upper) >= kWall) {
        ++walls;
      } else {
        openAxis = axis;
        openUpper = upper;
      }
    }
  }
  const bool roofed = coverage(grid, 1, false) >= kWall && coverage(grid, 1, true) >= kWall;
  if (roofed && walls == 3) return throughOpening(grid.bounds(), openAxis, openUpper, aspect);
  if (roofed && walls == 4 && somethingInside(grid)) return insideRoom(grid, aspect);
  return defaultCamera(grid.bounds());
}

}  // namespace lpv::cli
