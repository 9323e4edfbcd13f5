#include "scene/receiver_sampler.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "scene/emitter_list.h"
#include "scene/emitter_tree.h"
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

/// Every `every`th of a mesh's triangles in world space, counter-clockwise seen from the front.
template <typename Each>
void forEachTriangle(const Mesh& mesh, const Transform& transform, std::size_t every, Each each) {
  const glm::dmat4 world = transform.worldFromObject();
  const bool mirrored = transform.mirrors();
  for (std::size_t at = 0; at < mesh.triangles.size(); at += every) {
    glm::uvec3 t = mesh.triangles[at];
    if (mirrored) std::swap(t.y, t.z);
    glm::dvec3 corners[3];
    for (int i = 0; i < 3; ++i) corners[i] = world * glm::dvec4(glm::dvec3(mesh.positions[t[i]]), 1.0);
    each(corners);
  }
}

/// Mean of the texels of some rows; 1 without a texture.
glm::dvec3 meanOf(const TexturePtr& texture) {
  constexpr int kRows = 16;
  if (texture == nullptr || texture->texels.empty()) return glm::dvec3(1.0);
  std::vector<glm::vec3> texels;
  const int rows = std::min(kRows, texture->height);
  for (int i = 0; i < rows; ++i) appendLinearRow(*texture, int((i + 0.5) * texture->height / rows), texels);
  glm::dvec3 sum(0.0);
  for (const glm::vec3& texel : texels) sum += glm::dvec3(texel);
  return sum / double(texels.size());
}

/// The same of a light, or of the part of one.
glm::dvec3 meanFactor(const Light& light) {
  if (light.points == nullptr || light.points->empty()) return meanOf(light.texture);
  glm::dvec3 sum(0.0);
  double area = 0.0;
  for (const LightPoint& p : *light.points) {
    sum += double(p.area) * glm::dvec3(p.factor);
    area += double(p.area);
  }
  return sum / std::max(area, 1e-300);
}

/// To the nearest point of the segment from a to b.
double distanceToEdge(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& p) {
  const glm::dvec3 ab = b - a;
  const double along = glm::dot(ab, ab);
  const double t = along > 0.0 ? std::clamp(glm::dot(p - a, ab) / along, 0.0, 1.0) : 0.0;
  return glm::distance(p, a + t * ab);
}

double distanceToTriangle(const glm::dvec3 (&c)[3], const glm::dvec3& p) {
  const glm::dvec3 normal = glm::cross(c[1] - c[0], c[2] - c[0]);
  bool above = true;
  double edges = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &a = c[i], &b = c[(i + 1) % 3];
    above = above && glm::dot(glm::cross(normal, b - a), p - a) >= 0.0;
    edges = std::min(edges, distanceToEdge(a, b, p));
  }
  const double size = glm::length(normal);
  return above && size > 0.0 ? std::abs(glm::dot(normal, p - c[0])) / size : edges;
}

}  // namespace

LitSides::LitSides(const Scene& scene, const Grid& grid) {
  for (const auto& [name, surface] : scene.surfaces) add(*surface);
  if (scene.surfaces.empty()) addWalls(grid);
}

void LitSides::add(const Surface& surface) {
  Range range{triangles_.size(), 0, {}};
  forEachTriangle(*surface.mesh, surface.transform, 1,
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

AreaLights::AreaLights(const Scene& scene, std::size_t most) {
  for (const auto& [name, light] : scene.lights) {
    if (!emits(*light)) continue;
    const bool constant = light->texture == nullptr && light->mesh->directions.empty();
    const bool tree = !constant || light->mesh->evenTriangles().size() > kMostTreeTriangles;
    const double across = glm::length(glm::dmat3(light->transform.worldFromObject()) * light->mesh->bounds.extent());
    lights_.push_back(
        {emittedRadiance(*light) * meanFactor(*light), light->twoSided ? 2 : 1, light->group, tree, across, false});
    const std::size_t every = std::max<std::size_t>(1, light->mesh->triangles.size() / most);
    forEachTriangle(*light->mesh, light->transform, every, [&](const glm::dvec3(&c)[3]) {
      add({{c[0], c[1], c[2]}, lights_.size() - 1, double(every)});
    });
  }
}

void AreaLights::add(const Triangle& triangle) {
  const Emission& emission = lights_[triangle.light];
  const double mean = (emission.radiance.x + emission.radiance.y + emission.radiance.z) / 3.0;
  const double exitance = std::numbers::pi * emission.sides * mean;
  running_.push_back(power() + triangle.share * exitance * areaOf(triangle.corners));
  triangles_.push_back(triangle);
}

AreaLights AreaLights::thinned(std::size_t most, Random& random) const {
  AreaLights out;
  out.lights_ = lights_;
  const std::size_t each = std::max(kLeastOfALight, most / std::max<std::size_t>(lights_.size(), 1));
  for (std::size_t begin = 0, end = 0; begin < triangles_.size(); begin = end) {
    std::vector<double> area;
    for (; end < triangles_.size() && triangles_[end].light == triangles_[begin].light; ++end)
      area.push_back((area.empty() ? 0.0 : area.back()) + triangles_[end].share * areaOf(triangles_[end].corners));
    const std::size_t kept = std::min(each, area.size());
    out.lights_[triangles_[begin].light].thinned = kept < area.size();
    for (std::size_t i = 0; i < kept; ++i) {
      Triangle triangle = triangles_[begin + i];
      if (kept < area.size() && area.back() > 0.0) {
        triangle = triangles_[begin + pick(area, (double(i) + uniform(random)) / double(kept))];
        const double standsFor = area.back() / double(kept);
        triangle.share = standsFor / areaOf(triangle.corners);
        triangle.reach = std::sqrt(standsFor / std::numbers::pi);
      }
      out.add(triangle);
    }
  }
  return out;
}

void AreaLights::emit(Random& random, glm::dvec3* origin, glm::dvec3* direction) const {
  const Triangle& t = triangles_[pick(running_, uniform(random))];
  glm::dvec3 normal = glm::normalize(glm::cross(t.corners[1] - t.corners[0], t.corners[2] - t.corners[0]));
  if (lights_[t.light].sides == 2 && uniform(random) < 0.5) normal = -normal;
  *origin = pointOf(t.corners, random);
  *direction = cosineDirection(normal, random);
}

glm::dvec3 AreaLights::irradiance(const Receiver& at) const {
  return irradiance(at, std::vector<double>(lights_.size(), 1.0));
}

glm::dvec3 AreaLights::irradiance(const Receiver& at, std::span<const double> shares) const {
  glm::dvec3 e(0.0);
  for (std::size_t i = 0; i < triangles_.size();) {
    const std::size_t light = triangles_[i].light;
    const Emission& emission = lights_[light];
    double received = 0.0;
    if (shares[light] == 0.0) {
      while (i < triangles_.size() && triangles_[i].light == light) ++i;
      continue;
    }
    for (; i < triangles_.size() && triangles_[i].light == light; ++i) {
      const auto& c = triangles_[i].corners;
      const glm::dvec3 seen[3] = {c[0] - at.position, c[1] - at.position, c[2] - at.position};
      received += triangles_[i].share * triangleIrradiance(seen, at.normal, emission.sides);
    }
    // Few triangles that stand for many are too bright for what nearly touches them.
    e += shares[light] * (emission.thinned ? std::min(received, std::numbers::pi) : received) * emission.radiance;
  }
  return e;
}

void AreaLights::addMoments(const glm::dvec3& at, double weight, std::vector<Arriving>& perLight) const {
  for (const Triangle& t : triangles_) {
    const glm::dvec3 seen[3] = {t.corners[0] - at, t.corners[1] - at, t.corners[2] - at};
    const Arriving moments = triangleMoments(seen, lights_[t.light].sides);
    perLight[t.light].fluence += weight * t.share * moments.fluence;
    perLight[t.light].vectorIrradiance += weight * t.share * moments.vectorIrradiance;
  }
}

double AreaLights::distanceTo(const Triangle& t, const glm::dvec3& from, double limit) {
  const glm::dvec3 middle = (t.corners[0] + t.corners[1] + t.corners[2]) / 3.0;
  double radius = t.reach;
  for (const glm::dvec3& corner : t.corners) radius = std::max(radius, glm::distance(middle, corner));
  if (glm::distance(middle, from) - radius >= limit) return limit;
  return std::min(limit, std::max(0.0, distanceToTriangle(t.corners, from) - t.reach));
}

double AreaLights::distance(const glm::dvec3& from, double limit) const {
  for (const Triangle& t : triangles_) limit = distanceTo(t, from, limit);
  return limit;
}

std::vector<double> AreaLights::distancesToTrees(const glm::dvec3& from) const {
  std::vector<double> out(lights_.size(), std::numeric_limits<double>::infinity());
  for (const Triangle& t : triangles_) {
    if (lights_[t.light].tree) out[t.light] = distanceTo(t, from, out[t.light]);
  }
  return out;
}

LitPoints litPoints(const LitSides& sides, const AreaLights& lights, std::size_t mostTests, Random& random) {
  constexpr int kMostRays = 1024;
  LitPoints out;
  int rays = 0;
  for (std::size_t tests = 0; rays < kMostRays && tests < mostTests; ++rays) {
    glm::dvec3 origin, direction;
    lights.emit(random, &origin, &direction);
    tests += sides.cross(origin, direction, &out.at);
  }
  out.received = lights.power() * double(out.at.size()) / rays;
  return out;
}

}  // namespace lpv
