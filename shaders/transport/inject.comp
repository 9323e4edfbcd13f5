// Injection: voxelized lights into the field of emitted intensity. A dispatch walks the cells of one light, each of
// which is there once, so lights are added one after the other and the sum has one order.
//
// LPV_RETIRE: what an earlier tick put into these cells goes out.
// LPV_ADD:    this light goes in, its lobes (pairs) to N.
// LPV_DIVIDE: COUNT, after every light: eq. 1 of the paper with i = 1..N. With LPV_ADD: the only light, at once.
#extension GL_ARB_shader_ballot : enable
#extension GL_ARB_gpu_shader_int64 : enable
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"

#if !defined(LPV_RETIRE) && !defined(LPV_ADD) && !defined(LPV_DIVIDE)
#error "one of LPV_RETIRE, LPV_ADD and LPV_DIVIDE"
#endif

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { InjectParams params; };
layout(std430, binding = kVoxelCells) readonly buffer Voxels { VoxelHeader voxelHeader; uvec2 voxels[]; };
layout(std430, binding = kVoxelMoments) readonly buffer Moments { vec4 moments[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };
layout(std430, binding = kLobeCounts) buffer LobeCounts { float lobeCounts[]; };
layout(std430, binding = kCounters) buffer CounterBlock { Counters counters; };

int firstChannel() { return params.group * LPV_CHANNELS; }
int countOf(int cell) { return params.group * params.dims.x * params.dims.y * params.dims.z + cell; }

#ifdef LPV_ADD
vec4 lobesOf(vec4 moment) {
  return vec4(kLobe0 * params.sides * moment.x, kLobe1 * params.band1Factor * moment.zwy);
}

/// Threads that run in step count together: all of them come here at once and wait for one number.
void countTouched(bool first) {
#if defined(GL_ARB_shader_ballot) && defined(GL_ARB_gpu_shader_int64)
  const uint64_t together = ballotARB(first);
  const uvec2 askers = unpackUint2x32(together), before = unpackUint2x32(together & gl_SubGroupLtMaskARB);
  if (!first || (before.x | before.y) != 0u) return;
  atomicAdd(counters.touched, uint(bitCount(askers.x) + bitCount(askers.y)));
#else
  if (first) atomicAdd(counters.touched, 1u);
#endif
}

void addLight(uint slot, int cell, ivec3 position) {
  const float lobes = params.sides * float(voxels[slot].y);
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    if (params.weight[k] == 0.0) continue;  // uniform: a light of another chromaticity
#if LPV_TEXTURED
    const vec4 moment = moments[slot * uint(kColours) + uint(k)];
#else
    const vec4 moment = moments[slot];
#endif
    const int at = haloIndex(position, params.dims, firstChannel() + k);
#ifdef LPV_DIVIDE
    field[at] = params.weight[k] * lobesOf(moment) / lobes;
#else
    field[at] += params.weight[k] * lobesOf(moment);
#endif
  }
#ifdef LPV_DIVIDE
  countTouched(true);
  lobeCounts[countOf(cell)] = -lobes;
#else
  countTouched(lobeCounts[countOf(cell)] == 0.0);
  lobeCounts[countOf(cell)] += lobes;
#endif
}
#endif

void main() {
  const uint slot = gl_GlobalInvocationID.x;
#ifdef LPV_ADD
  if (slot == 0u) atomicAdd(counters.degenerate, voxelHeader.degenerate);
#endif
  if (slot >= voxelHeader.count) return;
  const int cell = int(voxels[slot].x);
  const ivec3 position = cellOfIndex(cell, params.dims);
#if defined(LPV_RETIRE)
  for (int k = 0; k < LPV_CHANNELS; ++k) field[haloIndex(position, params.dims, firstChannel() + k)] = vec4(0.0);
  lobeCounts[countOf(cell)] = 0.0;
#elif defined(LPV_ADD)
  addLight(slot, cell, position);
#else
  const float n = lobeCounts[countOf(cell)];
  if (n < 0.0) return;  // divided: another light's dispatch was here
  lobeCounts[countOf(cell)] = -n;
  for (int k = 0; k < LPV_CHANNELS; ++k) field[haloIndex(position, params.dims, firstChannel() + k)] /= n;
#endif
}
