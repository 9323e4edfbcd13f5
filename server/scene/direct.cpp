#include "scene/direct.h"

#include <algorithm>
#include <cmath>

namespace lpv {
namespace {

double edgeIrradiance(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& n) {
  const glm::dvec3 normal = glm::cross(p, q);
  const double size = glm::length(normal);
  return size > 0.0 ? std::atan2(size, glm::dot(p, q)) * glm::dot(normal, n) / size : 0.0;
}

/// One light's texels.
struct Part {
  const glm::vec4* first = nullptr;
  int count = 0;   ///< triangles or records
  int sides = 1;
  int stride = 2;  ///< texels of a record
};

double polygonIrradiance(const Part& part, const glm::dvec3& x, const glm::dvec3& n) {
  double sum = 0.0;
  for (int i = 0; i < part.count; ++i) {
    const glm::vec4* corner = part.first + 3 * i;
    const glm::dvec3 corners[3] = {glm::dvec3(corner[0]) - x, glm::dvec3(corner[1]) - x, glm::dvec3(corner[2]) - x};
    sum += triangleIrradiance(corners, n, part.sides);
  }
  return sum;
}

glm::dvec3 vplIrradiance(const Part& part, int record, const glm::dvec3& x, const glm::dvec3& n) {
  const glm::dvec4 first(part.first[record * part.stride]), second(part.first[record * part.stride + 1]);
  const glm::dvec3 d = glm::dvec3(first) - x;
  const double inverse = 1.0 / std::sqrt(std::max(glm::dot(d, d), 1e-6));
  const double facing = -glm::dot(glm::dvec3(second), d) * inverse;
  const double rounded = std::sqrt(facing * facing + second.w * second.w);
  const double intensity = part.sides > 1 ? rounded : 0.5 * (facing + rounded);
  const double e = intensity * std::max(0.0, glm::dot(n, d) * inverse) * std::min(inverse * inverse, 4.0);
  return part.stride == 3 ? e * glm::dvec3(part.first[record * 3 + 2]) : glm::dvec3(e);
}

glm::dvec3 treeIrradiance(const Part& part, const glm::dvec3& x, const glm::dvec3& n, double k) {
  glm::dvec3 sum(0.0);
  for (int at = 0; at < part.count;) {
    const glm::dvec4 node(part.first[at * part.stride]), next(part.first[at * part.stride + 1]);
    const int vpls = int(next.x), after = int(next.y);
    const glm::dvec3 d = glm::dvec3(node) - x;
    const bool whole = after == at + 1 + vpls || glm::dot(d, d) > k * k * node.w * node.w;
    for (int i = at + 1; whole && i <= at + vpls; ++i) sum += vplIrradiance(part, i, x, n);
    at = whole ? after : at + 1 + vpls;
  }
  return sum;
}

}  // namespace

double triangleIrradiance(const glm::dvec3 (&corners)[3], const glm::dvec3& n, int sides) {
  const double side = glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), corners[0]);
  if (side == 0.0 || (side > 0.0 && sides < 2)) return 0.0;
  glm::dvec3 leaves(0.0), returns(0.0);
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const glm::dvec3 &p = corners[i], &q = corners[(i + 1) % 3];
    const double hp = glm::dot(p, n), hq = glm::dot(q, n);
    if (hp <= 0.0 && hq <= 0.0) continue;
    const glm::dvec3 cut = hp * hq < 0.0 ? (p * hq - q * hp) / (hq - hp) : hp <= 0.0 ? p : q;
    if (hp > 0.0 && hq <= 0.0) leaves = cut;
    if (hp <= 0.0 && hq > 0.0) returns = cut;
    sum += edgeIrradiance(hp > 0.0 ? p : cut, hq > 0.0 ? q : cut, n);
  }
  sum += edgeIrradiance(leaves, returns, n);
  return 0.5 * std::abs(sum);
}

double DirectLights::farFromEmitters(const glm::dvec3& world) const {
  if (always) return 0.0;
  const glm::dvec3 g = grid.gridFromWorld(world);
  if (glm::any(glm::lessThan(g, glm::dvec3(-0.5))) || glm::any(glm::greaterThan(g, glm::dvec3(grid.dims) + 0.5)))
    return 0.0;
  const glm::dvec3 centred = glm::clamp(g - 0.5, glm::dvec3(0.0), glm::dvec3(grid.dims - 1));
  const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(centred)), glm::max(grid.dims - 2, glm::ivec3(0)));
  const glm::dvec3 f = centred - glm::dvec3(low);
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 axis = glm::mix(1.0 - f, f, glm::dvec3(offset));
    distance += axis.x * axis.y * axis.z * double(proximity[grid.index(glm::min(low + offset, grid.dims - 1))]);
  }
  const double t = std::clamp((distance - kNearBegin) / (kNearEnd - kNearBegin), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

glm::dvec3 DirectLights::irradiance(const glm::dvec3& world, const glm::dvec3& n) const {
  const glm::dvec3 x = grid.gridFromWorld(world);
  glm::dvec3 sum(0.0);
  for (int i = 0; i < int(texels[0].x); ++i) {
    const glm::vec4 radiance = texels[std::size_t(1 + 2 * i)], where = texels[std::size_t(2 + 2 * i)];
    const Part part = {&texels[std::size_t(where.x)], int(where.y), int(where.z), int(where.w)};
    if (radiance.w == 0.0F) {
      sum += glm::dvec3(radiance) * polygonIrradiance(part, x, n);
    } else {
      sum += glm::dvec3(radiance) * treeIrradiance(part, x, n, double(texels[0].y));
    }
  }
  return sum;
}

}  // namespace lpv
