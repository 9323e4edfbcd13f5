#include "coverage_rays.h"

#include <span>

namespace lpv::bench {

namespace {

constexpr std::size_t kHeader = sizeof(glm::uvec4);

const char* const kMarch = R"(
#ifndef LPV_BLEND
#error "LPV_BLEND: 0 direction, 1 path, 2 middle, 3 power"
#endif

// (cells along x, y, z, -), then four cells to a texel, in the memory order of Grid: shares closed along x, y and z, a byte
// each.
layout(binding = 0) uniform usamplerBuffer coverage;

const float kLeast = 1.0 / 512.0;  // what gets through counts as nothing

/// What a cell lets through of a ray that is in it from `at` to `leave`, 0..1 of its way; LPV_BLEND 3: the logarithm.
/// `way3`: how far the ray goes along the axes; `next`: where it leaves the cell's layer along each, which is a cell of
/// `inverse` long.
float passed(vec3 shares, vec3 way3, float at, float leave, vec3 next, vec3 inverse) {
#if LPV_BLEND == 0
  return 1.0 - dot(shares, way3) / (way3.x + way3.y + way3.z);
#elif LPV_BLEND == 1
  return max(1.0 - dot(shares, (leave - at) * way3), 0.0);
#elif LPV_BLEND == 2
  const vec3 middle = next - 0.5 * inverse;
  const vec3 open = 1.0 - shares * vec3(greaterThan(middle, vec3(at))) * vec3(lessThanEqual(middle, vec3(leave)));
  return open.x * open.y * open.z;
#else
  return dot(log2(max(1.0 - shares, 1e-30)), (leave - at) * way3);
#endif
}

/// Both ends lie in the grid.
vec2 answer(vec3 from, vec3 to) {
  const vec3 way3 = max(abs(to - from), 1e-6), inverse = 1.0 / way3;
  const bvec3 up = greaterThan(to, from);
  const ivec3 dims = ivec3(texelFetch(coverage, 0).xyz), cell = ivec3(from);
  const ivec3 step = ivec3(1, dims.x, dims.x * dims.y) * mix(ivec3(-1), ivec3(1), up);
  int index = 4 + cell.x + dims.x * (cell.y + dims.y * cell.z);
  vec3 next = mix(fract(from), 1.0 - fract(from), up) * inverse;
  float at = 0.0, cells = 0.0;
#if LPV_BLEND == 3
  float through = 0.0;
  const float least = log2(kLeast);
#else
  float through = 1.0;
  const float least = kLeast;
#endif
  while (at < 1.0 && through > least) {
    const float leave = min(min(next.x, next.y), min(next.z, 1.0));
    const vec3 shares = unpackUnorm4x8(texelFetch(coverage, index >> 2)[index & 3]).xyz;
    const float part = passed(shares, way3, at, leave, next, inverse);
#if LPV_BLEND == 3
    through += part;
#else
    through *= part;
#endif
    const bvec3 crossed = lessThanEqual(next, vec3(leave));
    index += (crossed.x ? step.x : 0) + (crossed.y ? step.y : 0) + (crossed.z ? step.z : 0);
    next += mix(vec3(0.0), inverse, crossed);
    at = leave;
    cells += 1.0;
  }
#if LPV_BLEND == 3
  through = exp2(through);
#endif
  return vec2(through > kLeast ? through : 0.0, cells);
}
)";

/// Moved by so many cells, away from a surface; `towards` lies in front of it.
glm::vec3 moved(const glm::vec3& p, const glm::vec3& normal, const glm::vec3& towards, const CoverageStart& start) {
  if (start.way == CoverageStart::Way::kNormal) return p + start.cells * normal;
  const float ahead = glm::dot(normal, towards - p);
  return ahead <= start.cells ? towards : glm::mix(p, towards, start.cells / ahead);
}

}  // namespace

ShadowRay marched(const ShadowRay& ray, const CoverageStart& start, const glm::ivec3& dims) {
  const glm::vec3 from = 2.0F * ray.from, to = 2.0F * ray.to;
  ShadowRay out = {from, to, ray.fromNormal, ray.toNormal};
  if (ray.fromNormal != glm::vec3(0.0F)) out.from = moved(from, ray.fromNormal, to, start);
  if (ray.toNormal != glm::vec3(0.0F)) out.to = moved(to, ray.toNormal, from, start);
  const glm::vec3 end = glm::vec3(dims) - 1e-3F;
  out.from = glm::clamp(out.from, glm::vec3(0.0F), end);
  out.to = glm::clamp(out.to, glm::vec3(0.0F), end);
  return out;
}

GpuCoverage::GpuCoverage(const CoverageGrid& grid)
    : cells_("coverage", kHeader + (grid.shares().size() + 3) / 4 * sizeof(glm::uvec4), gpu::BufferUse::kDynamic),
      view_("coverage", cells_, gpu::BufferTexel::kUvec4) {
  cells_.update(0, gpu::bytesOfValue(glm::uvec4(glm::uvec3(grid.dims()), 0)));
  update(grid, {glm::ivec3(0), grid.dims()});
}

/// All from the box's first cell to its last: that is copied faster than row by row.
void GpuCoverage::update(const CoverageGrid& grid, const CellBox& box) {
  if (box.cells() == 0) return;
  const auto indexOf = [&](const glm::ivec3& c) {
    const glm::ivec3& dims = grid.dims();
    return (std::size_t(c.z) * std::size_t(dims.y) + std::size_t(c.y)) * std::size_t(dims.x) + std::size_t(c.x);
  };
  const std::size_t first = indexOf(box.lower), count = indexOf(box.upper - 1) + 1 - first;
  cells_.update(kHeader + first * sizeof(glm::u8vec4),
                gpu::bytesOf(std::span<const glm::u8vec4>(grid.shares()).subspan(first, count)));
}

void GpuCoverage::bind() const { view_.bind(0); }

RayProgram coverageProgram(CoverageBlend blend) { return {"coverage", kMarch, {gpu::define("LPV_BLEND", int(blend))}}; }

}  // namespace lpv::bench
