#include "scene/emitter_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/emitter_walk.h"

namespace lpv {
namespace {

/// The kernel of the shaders, compiled in double.
namespace kernel {
using Scalar = double;
using Real = double;
using Across = double;
using Vector = glm::dvec3;
using glm::sign;
using glm::vec4;
using std::abs;
using std::clamp;
using std::max;
using std::min;
using std::sqrt;
double inversesqrt(double x) { return 1.0 / std::sqrt(x); }
#define LPV_RECEIVERS 1
#include "shaders/transport/vpl_kernel.glsl"
#undef LPV_RECEIVERS
}  // namespace kernel

double edgeIrradiance(const glm::dvec3& p, const glm::dvec3& q, const glm::dvec3& n) {
  const glm::dvec3 normal = glm::cross(p, q);
  const double size = glm::length(normal);
  return size > 0.0 ? std::atan2(size, glm::dot(p, q)) * glm::dot(normal, n) / size : 0.0;
}

/// Adds up what falls on a surface with unit normal n.
struct Irradiated {
  glm::dvec3 n;
  glm::dvec3 sum{0.0};

  void turned(const glm::dmat3& turn) { n = glm::normalize(turn * n); }
  void triangle(const glm::dvec3 (&corners)[3], int sides) { sum += triangleIrradiance(corners, n, sides); }
  void vpl(const SeenVpl& seen) {
    const glm::vec4* record = seen.record;
    const kernel::VplEntry vpl = kernel::vplEntry(record[0], record[1], record[2], record[3]);
    sum += kernel::irradianceFrom(vpl, vpl.position - seen.from, n, seen.sides > 1) * seen.colour;
  }
};

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

Arriving triangleMoments(const glm::dvec3 (&corners)[3], int sides) {
  const double side = glm::dot(glm::cross(corners[1] - corners[0], corners[2] - corners[0]), corners[0]);
  if (side == 0.0 || (side > 0.0 && sides < 2)) return {};
  const glm::dvec3 a = glm::normalize(corners[0]), b = glm::normalize(corners[1]), c = glm::normalize(corners[2]);
  const double volume = std::abs(glm::dot(a, glm::cross(b, c)));
  Arriving out;
  out.fluence = 2.0 * std::atan2(volume, 1.0 + glm::dot(a, b) + glm::dot(b, c) + glm::dot(c, a));
  for (const auto& [p, q] : {std::pair(a, b), {b, c}, {c, a}}) {
    const glm::dvec3 normal = glm::cross(p, q);
    const double sine = glm::length(normal);
    if (sine > 0.0) out.vectorIrradiance += 0.5 * std::atan2(sine, glm::dot(p, q)) / sine * normal;
  }
  if (side < 0.0) out.vectorIrradiance = -out.vectorIrradiance;
  return out;
}

Arriving lightFromVpl(const glm::vec4* entry, const glm::dvec3& receiver, int sides) {
  const kernel::VplEntry vpl = kernel::vplEntry(entry[0], entry[1], entry[2], entry[3]);
  const glm::dvec3 d = vpl.position - receiver;
  const kernel::Arriving light = kernel::arrivingFrom(vpl, d.x, d.y, d.z, sides > 1);
  return {light.fluence, {light.x, light.y, light.z}};
}

double EmitterList::farFromEmitters(const glm::dvec3& world) const {
  if (always) return 0.0;
  const glm::dvec3 g = grid.gridFromWorld(world);
  if (glm::any(glm::lessThan(g, glm::dvec3(0.5))) || glm::any(glm::greaterThan(g, glm::dvec3(grid.dims) - 0.5)))
    return 0.0;
  const glm::dvec3 centred = glm::clamp(g - 0.5, glm::dvec3(0.0), glm::dvec3(grid.dims - 1));
  const glm::ivec3 low = glm::min(glm::ivec3(glm::floor(centred)), glm::max(grid.dims - 2, glm::ivec3(0)));
  const glm::dvec3 f = centred - glm::dvec3(low);
  double distance = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    const glm::ivec3 offset(corner & 1, (corner >> 1) & 1, corner >> 2);
    const glm::dvec3 axis = glm::mix(1.0 - f, f, glm::dvec3(offset));
    distance += axis.x * axis.y * axis.z * double(emitterDistance[grid.index(glm::min(low + offset, grid.dims - 1))]);
  }
  const double t = std::clamp((distance - kNearFieldBegin) / (kNearFieldEnd - kNearFieldBegin), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

glm::dvec3 EmitterList::irradiance(const glm::dvec3& world, const glm::dvec3& n) const {
  const glm::dvec3 direct = fromLights(world, n, visibility.get());
  return reflected == nullptr ? direct : direct + reflected->irradiance(world, n, visibility.get());
}

glm::dvec3 EmitterList::fromLight(std::size_t light, const glm::dvec3& x, const glm::dvec3& n) const {
  Irradiated on{n};
  seeLight(*this, light, x, on);
  return emitterRadiance(*this, light) * on.sum;
}

glm::dvec3 EmitterList::lookedAt(const glm::dvec3& world, const glm::dvec3& n) const {
  const glm::dvec3 x = grid.gridFromWorld(world);
  const std::size_t first = 1 + 2 * std::size_t(texels[0].x);
  glm::dvec3 sum(0.0);
  for (std::size_t i = first; i < first + std::size_t(texels[0].z); ++i)
    sum += double(texels[i].y) * fromLight(std::size_t(texels[i].x), x, n);
  return sum;
}

glm::dvec3 EmitterList::fromLights(const glm::dvec3& world, const glm::dvec3& n, const LightVisibility* through) const {
  const glm::dvec3 x = grid.gridFromWorld(world);
  glm::dvec3 sum(0.0);
  for (std::size_t i = 0; i < std::size_t(texels[0].x); ++i) {
    const glm::dvec3 e = fromLight(i, x, n);
    if (e == glm::dvec3(0.0)) continue;
    sum += through == nullptr ? e : e * through->share(world, n, i);
  }
  return sum;
}

}  // namespace lpv
