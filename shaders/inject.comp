// Injection, over touched cells only. LPV_RETIRE: last tick's cells emit nothing any more. Otherwise eq. 1 of the
// paper with i = 1..N, times one cell face s^2 (MATHS.md 2, COUNT), and the accumulators are left at zero for the
// next tick.
#include "layout.h"
#include "field.glsl"

#ifndef LPV_RETIRE
#error "LPV_RETIRE: 0 or 1"
#endif

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { InjectParams params; };
layout(std430, binding = kTouchedCells) readonly buffer Touched { uint header[kListHeaderWords]; uint cells[]; };
layout(std430, binding = kAccumulators) buffer Accumulators { int words[]; };
layout(std430, binding = kFieldOut) writeonly buffer Field { vec4 field[]; };

vec4 emittedIntensity(int base, float scale) {
  vec4 sum;
  for (int j = 0; j < 4; ++j) {
    sum[j] = float(words[base + j]);
    words[base + j] = 0;
  }
  return sum * scale;
}

void main() {
  const uint slot = gl_GlobalInvocationID.x;
  if (slot >= header[3]) return;
  const int cell = int(cells[slot]);
  const ivec3 dims = params.dims.xyz;
  const ivec3 position = cellOfIndex(cell, dims);
#if !LPV_RETIRE
  const int base = cell * kAccumulatorWords;
  const float scale = params.scale.x / float(words[base + kCountWord]);
  words[base + kCountWord] = 0;
#endif
  for (int k = 0; k < LPV_CHANNELS; ++k) {
#if LPV_RETIRE
    field[haloIndex(position, dims, k)] = vec4(0.0);
#else
    field[haloIndex(position, dims, k)] = emittedIntensity(base + 4 * k, scale);
#endif
  }
}
