#include "scene/emitter_list.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "scene/emitter_tree.h"
#include "shaders/layout.h"

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

/// One light's texels.
struct Part {
  const glm::vec4* first = nullptr;
  int count = 0;   ///< triangles or records
  int sides = 1;
  int stride = 4;  ///< texels of a record
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

constexpr int kColouredRecord = 5;  ///< texels; others have 4

glm::dvec3 vplIrradiance(const Part& part, int at, const glm::dvec3& x, const glm::dvec3& n) {
  const glm::vec4* record = part.first + at * part.stride;
  const kernel::VplEntry vpl = kernel::vplEntry(record[0], record[1], record[2], record[3]);
  const double e = kernel::irradianceFrom(vpl, vpl.position - x, n, part.sides > 1);
  return part.stride == kColouredRecord ? e * glm::dvec3(record[4]) : glm::dvec3(e);
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

/// `part` begins with the matrix to the tree's space.
double emitterTreeIrradiance(const Part& part, const glm::dvec3& x, const glm::dvec3& n, double k) {
  const auto row = [&part](int i) { return glm::dvec4(part.first[i]); };
  const glm::dmat3 turn = glm::transpose(glm::dmat3(glm::dvec3(row(0)), glm::dvec3(row(1)), glm::dvec3(row(2))));
  const glm::dvec3 at = turn * x + glm::dvec3(row(0).w, row(1).w, row(2).w), normal = glm::normalize(turn * n);
  const Part tree = {part.first + layout::kTreeSpaceTexels, part.count, part.sides, layout::kPlainEntryTexels};
  double sum = 0.0;
  for (int i = 0; i < tree.count;) {
    const glm::dvec4 node(tree.first[i * tree.stride]), next(tree.first[i * tree.stride + 1]);
    const int vpls = int(next.x), after = int(next.y);
    const glm::dvec3 d = glm::dvec3(node) - at;
    const bool far = glm::dot(d, d) > k * k * node.w * node.w;
    for (int v = i + 1; far && v <= i + vpls; ++v) sum += vplIrradiance(tree, v, at, normal).x;
    if (!far) sum += polygonIrradiance({part.first + int(next.w), int(next.z), part.sides, 0}, at, normal);
    i = far ? after : i + 1 + vpls;
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
  const glm::vec4 radiance = texels[1 + 2 * light], where = texels[2 + 2 * light];
  const Part part = {&texels[std::size_t(where.x)], int(where.y), int(where.z), int(where.w)};
  const glm::dvec3 e = radiance.w == layout::kAsPolygons ? glm::dvec3(polygonIrradiance(part, x, n))
                       : radiance.w == layout::kAsEmitterTree
                           ? glm::dvec3(emitterTreeIrradiance(part, x, n, double(texels[0].y)))
                           : treeIrradiance(part, x, n, double(texels[0].y));
  return glm::dvec3(radiance) * e;
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
