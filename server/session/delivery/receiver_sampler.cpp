#include "session/delivery/receiver_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "scene/emitter_list.h"
#include "scene/intersect.h"

namespace lpv {

namespace {

double uniform(Random& random) { return std::uniform_real_distribution<double>(0.0, 1.0)(random); }

/// Index of the entry that a share in [0, 1) of the last running sum falls into.
std::size_t pick(const std::vector<double>& running, double share) {
  const auto found = std::upper_bound(running.begin(), running.end(), share * running.back());
  return std::min(std::size_t(found - running.begin()), running.size() - 1);
}

/// Uniform over a triangle (Turk 1990).
glm::dvec3 pointOf(const glm::dvec3 (&c)[3], Random& random) {
  const double u = std::sqrt(uniform(random)), v = uniform(random);
  return (1.0 - u) * c[0] + u * (1.0 - v) * c[1] + u * v * c[2];
}

double areaOf(const glm::dvec3 (&c)[3]) { return 0.5 * glm::length(glm::cross(c[1] - c[0], c[2] - c[0])); }

/// About the unit vector n, density cos / pi (Duff et al. 2017 for the frame).
glm::dvec3 cosineDirection(const glm::dvec3& n, Random& random) {
  const double sign = std::copysign(1.0, n.z), a = -1.0 / (sign + n.z), b = n.x * n.y * a;
  const glm::dvec3 t(1.0 + sign * n.x * n.x * a, sign * b, -sign * n.x), s(b, sign + n.y * n.y * a, -n.y);
  const double r = std::sqrt(uniform(random)), phi = 2.0 * std::numbers::pi * uniform(random);
  return r * std::cos(phi) * t + r * std::sin(phi) * s + std::sqrt(std::max(0.0, 1.0 - r * r)) * n;
}

bool emits(const Light& light) { return light.enabled && emittedRadiance(light) != glm::dvec3(0.0); }

/// A mesh's triangles in world space, counter-clockwise seen from the front.
template <typename Each>
void forEachTriangle(const Mesh& mesh, const Transform& transform, Each each) {
  const glm::dmat4 world = transform.worldFromObject();
  const bool mirrored = transform.mirrors();
  for (glm::uvec3 t : mesh.triangles) {
    if (mirrored) std::swap(t.y, t.z);
    glm::dvec3 corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = world * glm::dvec4(glm::dvec3(mesh.positions[t[i]]), 1.0);
    each(corners);
  }
}

}  // namespace

LitSides::LitSides(const Scene& scene) {
  for (const auto& [name, surface] : scene.surfaces) add(*surface);
  if (scene.surfaces.empty()) addWalls(scene.grid);
}

void LitSides::add(const Surface& surface) {
  Range range{triangles_.size(), 0, {}};
  forEachTriangle(*surface.mesh, surface.transform,
                  [&](const glm::dvec3(&corners)[3]) { add(corners, surface.twoSided, &range); });
  range.end = triangles_.size();
  ranges_.push_back(range);
}

void LitSides::addWalls(const Grid& grid) {
  Range range{triangles_.size(), 0, {}};
  for (int axis = 0; axis < 3; ++axis) {
    for (const double side : {0.1, 0.9}) {
      glm::dvec3 c[4];
      for (int i = 0; i < 4; ++i) {
        c[i][axis] = side;
        c[i][(axis + 1) % 3] = i == 1 || i == 2 ? 0.9 : 0.1;
        c[i][(axis + 2) % 3] = i >= 2 ? 0.9 : 0.1;
        c[i] = grid.worldFromGrid(c[i] * glm::dvec3(grid.dims));
      }
      if (side > 0.5) std::swap(c[1], c[3]);  // the upper wall faces down
      add({c[0], c[1], c[2]}, false, &range);
      add({c[0], c[2], c[3]}, false, &range);
    }
  }
  range.end = triangles_.size();
  ranges_.push_back(range);
}

void LitSides::add(const glm::dvec3 (&c)[3], bool twoSided, Range* range) {
  const double area = areaOf(c);
  if (!(area > 0.0)) return;
  triangles_.push_back({{c[0], c[1], c[2]}, glm::normalize(glm::cross(c[1] - c[0], c[2] - c[0])), twoSided});
  running_.push_back(this->area() + (twoSided ? 2.0 : 1.0) * area);
  for (const glm::dvec3& corner : c) range->box.add(corner);
}

Receiver LitSides::sample(Random& random) const {
  const Triangle& t = triangles_[pick(running_, uniform(random))];
  const bool back = t.twoSided && uniform(random) < 0.5;
  return {pointOf(t.corners, random), back ? -t.normal : t.normal};
}

std::size_t LitSides::cross(const glm::dvec3& origin, const glm::dvec3& direction, std::vector<Receiver>* out) const {
  std::size_t looked = 0;
  for (const Range& range : ranges_) {
    if (!meetsBox(range.box, origin, direction, std::numeric_limits<double>::infinity())) continue;
    looked += range.end - range.begin;
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const Triangle& t = triangles_[i];
      const bool back = glm::dot(t.normal, direction) > 0.0;
      if (back && !t.twoSided) continue;
      glm::dvec3 normal(0.0);
      const double distance = meetsTriangle(t.corners[0], t.corners[1], t.corners[2], origin, direction, &normal);
      if (distance > 0.0 && std::isfinite(distance))
        out->push_back({origin + distance * direction, back ? -t.normal : t.normal});
    }
  }
  return looked;
}

AreaLights::AreaLights(const Scene& scene) {
  for (const auto& [name, light] : scene.lights) {
    if (!emits(*light)) continue;
    lights_.push_back({emittedRadiance(*light), light->twoSided ? 2 : 1});
    const Emission& emission = lights_.back();
    const double exitance =
        std::numbers::pi * emission.sides * (emission.radiance.x + emission.radiance.y + emission.radiance.z) / 3.0;
    forEachTriangle(*light->mesh, light->transform, [&](const glm::dvec3(&c)[3]) {
      triangles_.push_back({{c[0], c[1], c[2]}, lights_.size() - 1});
      running_.push_back(power() + exitance * areaOf(c));
    });
  }
}

void AreaLights::emit(Random& random, glm::dvec3* origin, glm::dvec3* direction) const {
  const Triangle& t = triangles_[pick(running_, uniform(random))];
  glm::dvec3 normal = glm::normalize(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
  if (lights_[t.light].sides == 2 && uniform(random) < 0.5) normal = -normal;
  *origin = pointOf(t.corners, random);
  *direction = cosineDirection(normal, random);
}

glm::dvec3 AreaLights::irradiance(const Receiver& at) const {
  glm::dvec3 e(0.0);
  for (const Triangle& t : triangles_) {
    const glm::dvec3 seen[3] = {t.corners[0] - at.position, t.corners[1] - at.position, t.corners[2] - at.position};
    const Emission& emission = lights_[t.light];
    e += triangleIrradiance(seen, at.normal, emission.sides) * emission.radiance;
  }
  return e;
}

}  // namespace lpv
