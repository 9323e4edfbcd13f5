// What a light's VPLs emit, cell by cell, as the field of emitted intensity shows it (MATHS.md 2): for those who look at
// the injected volume. A thread per leaf of the tree.
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"
#include "transport/vpls.glsl"

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { InjectParams params; };
layout(std430, binding = kTreeNodes) readonly buffer Nodes { uvec4 nodes[]; };  // the leaves are the first of them
layout(std430, binding = kTreeEntries) readonly buffer Entries { vec4 entries[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };

void main() {
  const ivec3 size = params.boxSize;
  const int leaf = int(gl_GlobalInvocationID.x);
  if (leaf >= size.x * size.y * size.z || nodes[leaf].z == 0u) return;
  const ivec3 cell = params.boxLower + ivec3(leaf % size.x, (leaf / size.x) % size.y, leaf / (size.x * size.y));
  const int header = int(nodes[leaf].w);
  const int vpls = int(entries[header * kEntryTexels + 1].x);
  vec4 emitted[3] = vec4[3](vec4(0.0), vec4(0.0), vec4(0.0));
  for (int i = 1; i <= vpls; ++i) {
    const int at = (header + i) * kEntryTexels;
    const vec4 lobes = vec4(kLobe0 * params.sides * entries[at].w, kLobe1 * params.band1Factor * entries[at + 1].yzx);
    for (int k = 0; k < LPV_CHANNELS; ++k) {
#if LPV_TEXTURED
      emitted[k] += lobes * entries[at + 4][k];
#else
      emitted[k] += lobes;
#endif
    }
  }
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    field[haloIndex(cell, params.dims, params.group * LPV_CHANNELS + k)] += params.weight[k] * emitted[k];
  }
}
