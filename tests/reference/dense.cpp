#include "reference/dense.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

namespace lpv::reference {
namespace {

double real(std::uint32_t x) { return double(x >> 8) * 0x1p-24 + 0x1p-25; }

std::optional<glm::ivec3> nearestCell(const Grid& grid, const glm::dvec3& world) {
  const glm::dvec3 g = grid.gridFromWorld(world);
  glm::ivec3 cell(0);
  for (int k = 0; k < 3; ++k) {
    if (!(g[k] >= 0.0 && g[k] <= grid.dims[k])) return std::nullopt;
    cell[k] = std::min(int(std::floor(g[k])), grid.dims[k] - 1);
  }
  return cell;
}

}  // namespace

std::uint32_t fmix32(std::uint32_t x) {
  x ^= x >> 16;
  x *= 0x85EBCA6BU;
  x ^= x >> 13;
  x *= 0xC2B2AE35U;
  return x ^ (x >> 16);
}

glm::dvec2 hashedPair(std::uint32_t triangle, std::uint32_t sample) {
  const std::uint32_t h = (triangle * 0x9E3779B9U) ^ (sample * 0x85EBCA6BU);
  return {real(fmix32(h)), real(fmix32(h + 0x68BC21EBU))};
}

glm::dvec3 turk(const glm::dvec2& r) {
  const double root = std::sqrt(r.x);
  return {1.0 - root, root * (1.0 - r.y), root * r.y};
}

Counted injectDense(const Grid& grid, const std::vector<Emitter>& emitters, std::uint32_t samples,
                    const SampleSource& source) {
  Counted out(grid);
  for (const Emitter& e : emitters) {
    for (std::uint32_t i = 0; i < samples; ++i) {
      glm::dvec3 b = turk(source(e.triangle, i));
      if (e.swapped) std::swap(b.y, b.z);
      const std::optional<glm::ivec3> cell = nearestCell(grid, e.positionAt(b));
      if (!cell) continue;
      const glm::dvec3 texture = e.texture ? bilinear(e.texture->levels[0], e.uvAt(b)) : glm::dvec3(1.0);
      out.add(*cell, e.radiance * texture, e.directionAt(b), e.twoSided);
    }
  }
  out.divide(grid.cell);
  return out;
}

}  // namespace lpv::reference
