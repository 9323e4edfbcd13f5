#include "scene/default_view.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/occupancy.h"

namespace lpv {
namespace {

constexpr int kCellsOfLongestEdge = 48;
constexpr int kMostCells = 256;             ///< ... of a long and low room, whose height takes kCellsOfHeight
constexpr int kCellsOfHeight = 8;
constexpr int kLeastCellsOfRoom = 3;        ///< along any edge: with fewer, walls and inside are the same cells
constexpr double kWall = 0.8;               ///< a side counts as a wall if this share of it is covered
constexpr double kShell = 1.0 / 3.0;        ///< ... by something in the outer part of this depth
constexpr double kRoomFov = 60.0;           ///< degrees, vertical, of the view inside a room
constexpr double kRoomAspect = 16.0 / 9.0;  ///< of the picture that the place inside a room is chosen for
constexpr double kOpenFov = 40.0;           ///< degrees, vertical, through an open side
constexpr int kMostFaces = 256;             ///< triangles of a light that are asked what they shine on
constexpr double kEnclosed = 0.75;  ///< a face shines on the inside if this share of its directions ends there

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

/// Which sides of a scene's bounds are closed.
struct Sides {
  bool roofed = false;  ///< above and below
  int walls = 0;  ///< of four
  int openAxis = 0;  ///< the last side that is no wall
  bool openUpper = false;
};

Sides sidesOf(const Occupancy& grid) {
  Sides sides;
  if (std::min({grid.dims().x, grid.dims().y, grid.dims().z}) < kLeastCellsOfRoom) return sides;
  for (const int axis : {0, 2}) {
    for (const bool upper : {false, true}) {
      if (coverage(grid, axis, upper) >= kWall) {
        ++sides.walls;
      } else {
        sides.openAxis = axis;
        sides.openUpper = upper;
      }
    }
  }
  sides.roofed = coverage(grid, 1, false) >= kWall && coverage(grid, 1, true) >= kWall;
  return sides;
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

/// Cells along the longest edge: more where a scene is long and low, so that a corridor has an inside.
int cellsFor(const Bounds& content) {
  const glm::dvec3 extent = content.extent();
  const double ratio = std::max({extent.x, extent.y, extent.z}) / std::min({extent.x, extent.y, extent.z});
  const double cells = std::ceil(ratio * kCellsOfHeight);
  return cells <= kMostCells ? std::max(kCellsOfLongestEdge, int(cells)) : kCellsOfLongestEdge;
}

/// Whether what a face sees ends within the grid.
bool shinesInside(const Occupancy& grid, const glm::dvec3& at, const glm::dvec3& normal) {
  int blocked = 0;
  int all = 0;
  for (int i = 0; i < 27; ++i) {
    const glm::dvec3 lattice(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
    if (i == 13 || glm::dot(glm::normalize(lattice), normal) < 0.3) continue;
    ++all;
    blocked += grid.isBlocked(at, glm::normalize(lattice), 2.0 * grid.cell()) ? 1 : 0;
  }
  return blocked >= kEnclosed * all;
}

/// Whether most of the lights' area shines on the inside of the scene's sides.
bool lightInside(const Scene& scene, const Occupancy& grid) {
  double inside = 0.0;
  double all = 0.0;
  for (const auto& [name, light] : scene.lights) {
    if (!light->enabled || light->distant) continue;
    const glm::dmat4 worldFromObject = light->transform.worldFromObject();
    const double side = glm::determinant(glm::dmat3(worldFromObject)) < 0.0 ? -1.0 : 1.0;
    const Mesh& mesh = *light->mesh;
    const std::size_t step = mesh.triangles.size() / kMostFaces + 1;
    for (std::size_t i = 0; i < mesh.triangles.size(); i += step) {
      glm::dvec3 v[3];
      for (int k = 0; k < 3; ++k) {
        v[k] = worldFromObject * glm::dvec4(glm::dvec3(mesh.positions[mesh.triangles[i][k]]), 1.0);
      }
      const glm::dvec3 across = glm::cross(v[1] - v[0], v[2] - v[0]) * side;
      const double area = glm::length(across);
      if (!(area > 0.0)) continue;
      all += area * double(step);
      const glm::dvec3 centre = (v[0] + v[1] + v[2]) / 3.0;
      if (shinesInside(grid, centre, across / area) ||
          (light->twoSided && shinesInside(grid, centre, across / -area))) {
        inside += area * double(step);
      }
    }
  }
  return all > 0.0 && inside >= 0.5 * all;
}

Camera withRange(Camera camera, const Bounds& bounds) {
  const double size = glm::length(bounds.extent());
  camera.near = std::max(size * 1e-3, 1e-6);
  camera.far = size * 10.0;
  return camera;
}

/// A view through the open side that shows all of it.
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

/// Score of a view: the mean free distance over the frame, reduced by things close to the eye.
double openness(const Occupancy& grid, const Camera& camera, double length) {
  constexpr int kAcross = 9;
  constexpr int kDown = 5;
  double sum = 0.0;
  for (int i = 0; i < kAcross; ++i) {
    for (int j = 0; j < kDown; ++j) {
      const glm::dvec3 ray = camera.rayDirection((i + 0.5) / kAcross, (j + 0.5) / kDown, kRoomAspect);
      const double distance = grid.freeDistance(camera.eye, ray);
      sum += distance < 0.12 * length ? -length : std::min(distance, length);
    }
  }
  return sum;
}

/// The best of several positions near either end.
Camera insideRoom(const Occupancy& grid) {
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
      const double score = openness(grid, camera, extent[along]);
      if (score <= bestScore) continue;
      bestScore = score;
      best = camera;
    }
  }
  return withRange(best, bounds);
}

}  // namespace

DefaultView::DefaultView(const Scene& scene) {
  const Bounds content = contentBounds(scene);
  if (content.empty() || !std::isfinite(glm::length(content.extent()))) return;
  bounds_ = content;
  const Occupancy grid(scene, cellsFor(content));
  const Sides sides = sidesOf(grid);
  if (sides.roofed && sides.walls == 3) {
    kind_ = Kind::kThroughOpening;
    openAxis_ = sides.openAxis;
    openUpper_ = sides.openUpper;
  } else if (sides.roofed && sides.walls == 4 && (somethingInside(grid) || lightInside(scene, grid))) {
    kind_ = Kind::kInside;
    inside_ = insideRoom(grid);
  }
}

Camera DefaultView::camera(double aspect) const {
  switch (kind_) {
    case Kind::kInside:
      return inside_;
    case Kind::kThroughOpening:
      return throughOpening(bounds_, openAxis_, openUpper_, aspect);
    case Kind::kOutside:
      break;
  }
  return defaultCamera(bounds_);
}

}  // namespace lpv
