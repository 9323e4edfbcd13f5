// Injection: voxelized lights into the field of emitted intensity. A dispatch walks the cells of one light, each of
// which is there once, so lights are added one after the other and the sum has one order.
//
// LPV_RETIRE: what an earlier tick put into these cells goes out.
// LPV_ADD:    this light goes in, its lobes (pairs) to N.
// LPV_DIVIDE: COUNT, after every light: eq. 1 of the paper with i = 1..N.
#include "layout.h"
#include "field.glsl"
#include "sh.glsl"

#if !defined(LPV_RETIRE) && !defined(LPV_ADD) && !defined(LPV_DIVIDE)
#error "one of LPV_RETIRE, LPV_ADD and LPV_DIVIDE"
#endif

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { InjectParams params; };
layout(std430, binding = kVoxelCells) readonly buffer Voxels { uint header[kVoxelHeaderWords]; uvec2 voxels[]; };
layout(std430, binding = kVoxelMoments) readonly buffer Moments { vec4 moments[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };
layout(std430, binding = kLobeCounts) buffer LobeCounts { float lobeCounts[]; };
layout(std430, binding = kCounters) buffer CounterBlock { Counters counters; };

int firstChannel() { return params.dims.w * LPV_CHANNELS; }
int countOf(int cell) { return params.dims.w * params.dims.x * params.dims.y * params.dims.z + cell; }

#ifdef LPV_ADD
vec4 lobesOf(vec4 moment) {
  return vec4(kLobe0 * params.lobe.x * moment.x, kLobe1 * params.lobe.y * moment.zwy);
}

void addLight(uint slot, int cell, ivec3 position) {
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    if (params.weight[k] == 0.0) continue;  // uniform: a light of another chromaticity
#if LPV_TEXTURED
    const vec4 moment = moments[slot * 3u + uint(k)];
#else
    const vec4 moment = moments[slot];
#endif
    field[haloIndex(position, params.dims.xyz, firstChannel() + k)] += params.weight[k] * lobesOf(moment);
  }
  if (lobeCounts[countOf(cell)] == 0.0) atomicAdd(counters.touched, 1u);
  lobeCounts[countOf(cell)] += params.lobe.x * float(voxels[slot].y);
}
#endif

void main() {
  const uint slot = gl_GlobalInvocationID.x;
#ifdef LPV_ADD
  if (slot == 0u) atomicAdd(counters.degenerate, header[4]);
#endif
  if (slot >= header[3]) return;
  const int cell = int(voxels[slot].x);
  const ivec3 position = cellOfIndex(cell, params.dims.xyz);
#if defined(LPV_RETIRE)
  for (int k = 0; k < LPV_CHANNELS; ++k) field[haloIndex(position, params.dims.xyz, firstChannel() + k)] = vec4(0.0);
  lobeCounts[countOf(cell)] = 0.0;
#elif defined(LPV_ADD)
  addLight(slot, cell, position);
#else
  const float n = lobeCounts[countOf(cell)];
  if (n < 0.0) return;  // divided: another light's dispatch was here
  lobeCounts[countOf(cell)] = -n;
  for (int k = 0; k < LPV_CHANNELS; ++k) field[haloIndex(position, params.dims.xyz, firstChannel() + k)] /= n;
#endif
}
