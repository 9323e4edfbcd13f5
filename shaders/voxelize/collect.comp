// One light's sums, out of the accumulators into its own list of cells; the accumulators are left at zero. What is
// written is relative to the light: COUNT sums of unit lobes, FLUX areas as shares of what the scale was made for.
#include "layout.h"

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { VoxelizeParams params; };
#include "voxelize/accumulators.glsl"
layout(std430, binding = kVoxelMoments) writeonly buffer Moments { vec4 moments[]; };

#if LPV_SETS
/// Lobes of the triangles in a set, rounded and summed as addLobes() does.
ivec3 sumOfSet(uint set) {
  const float scale = float(params.momentUnits);
  ivec3 sum = ivec3(0);
  for (; set != 0u; set &= set - 1u) sum += ivec3(roundEven(scale * params.normals[findLSB(set)].xyz));
  return sum;
}
#endif

float fixedPoint(int at) {
#if LPV_FLUX
  uvec2 bits = uvec2(words[at], words[at + 1]);
  words[at] = words[at + 1] = 0u;
  const bool negative = bits.y >= 0x80000000u;
  if (negative) bits = uvec2(0u - bits.x, ~bits.y + (bits.x == 0u ? 1u : 0u));
  const float size = float(bits.y) * 4294967296.0 + float(bits.x);
  return negative ? -size : size;
#else
  const int value = int(words[at]);
  words[at] = 0u;
  return float(value);
#endif
}

void main() {
  const uint slot = gl_GlobalInvocationID.x;
  if (slot >= voxelHeader.count) return;
  const int base = int(voxels[slot].x) * kAccumulatorWords;
#if LPV_SETS
  const uint set = words[base];
  const uint count = uint(bitCount(set));
#else
  const uint count = words[base];
#endif
  const float unit = float(1.0lf / params.momentUnits);
  words[base] = 0u;
  voxels[slot].y = count;
#if LPV_SETS
  moments[slot] = vec4(float(count), vec3(sumOfSet(set)) * unit);
#elif LPV_FLUX || LPV_TEXTURED
  const int stride = LPV_FLUX == 1 ? kWideWords : 1;
  for (int k = 0; k < kMomentsPerCell; ++k) {
    vec4 m;
    for (int i = 0; i < kMomentParts; ++i) m[i] = fixedPoint(base + kFirstSum + stride * (kMomentParts * k + i)) * unit;
    moments[int(slot) * kMomentsPerCell + k] = m;
  }
#else
  vec3 directions;
  for (int i = 0; i < 3; ++i) directions[i] = fixedPoint(base + kFirstSum + i) * unit;
  moments[slot] = vec4(float(count), directions);
#endif
}
