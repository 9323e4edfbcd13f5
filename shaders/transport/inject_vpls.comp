// What a light's VPLs emit, cell by cell, as the field of emitted intensity shows it (MATHS.md 2): for those who look at
// the injected volume. A thread per cell of the product that the light's box meets: it takes the leaves of the tree within
// it, or, where these are larger, of the one around it the VPLs that lie within it.
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"
#include "transport/vpls.glsl"

layout(local_size_x = kCellGroup) in;

layout(std140, binding = kParams) uniform Block { InjectParams params; };
layout(std430, binding = kTreeNodes) readonly buffer Nodes { uvec4 nodes[]; };  // the leaves are the first of them
layout(std430, binding = kTreeEntries) readonly buffer Entries { vec4 entries[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };

vec4 emitted[LPV_CHANNELS];

/// The product's outer upper faces belong to its last cells; what snapping can move beyond them, too.
bool isWithin(vec3 position, ivec3 cell) {
  const vec3 p = position - vec3(cell), faces = mix(vec3(1.0), vec3(1.0 + 1.0 / kLatticeUnits), equal(cell + 1, params.upper));
  return all(greaterThanEqual(p, vec3(0.0))) && all(lessThan(p, faces));
}

void addVpl(int at) {
  const vec4 lobes = vec4(kLobe0 * params.sides * entries[at].w, kLobe1 * params.band1Factor * entries[at + 1].yzx);
  for (int k = 0; k < LPV_CHANNELS; ++k) {
#if LPV_TEXTURED
    emitted[k] += lobes * entries[at + 4][k];
#else
    emitted[k] += lobes;
#endif
  }
}

void addLeaf(ivec3 at, ivec3 cell, bool whole) {
  const ivec3 size = params.boxSize;
  const int leaf = (at.z * size.y + at.y) * size.x + at.x;
  if (nodes[leaf].z == 0u) return;
  const int header = int(nodes[leaf].w);
  const int vpls = int(entries[header * kEntryTexels + 1].x);
  for (int i = 1; i <= vpls; ++i) {
    const int vpl = (header + i) * kEntryTexels;
    if (whole || isWithin(entries[vpl].xyz, cell)) addVpl(vpl);
  }
}

void main() {
  const ivec3 count = params.cellCount;
  const int thread = int(gl_GlobalInvocationID.x);
  if (thread >= count.x * count.y * count.z) return;
  const ivec3 at = ivec3(thread % count.x, (thread / count.x) % count.y, thread / (count.x * count.y));
  const ivec3 cell = params.firstCell + at;
  for (int k = 0; k < LPV_CHANNELS; ++k) emitted[k] = vec4(0.0);
  // Leaves from the cell's lower faces to its upper ones; of the product's last cells one more, for what lies on the face.
  const vec3 from = (vec3(cell) - params.origin) / params.cell, to = from + 1.0 / params.cell;
  const ivec3 first = ivec3(floor(from)) - params.boxLower, last = ivec3(ceil(to)) - 1 - params.boxLower;
  const bvec3 outermost = equal(cell + 1, params.upper);
  const ivec3 lower = max(first, ivec3(0)), upper = min(last + ivec3(outermost), params.boxSize - 1);
  for (int z = lower.z; z <= upper.z; ++z) {
    for (int y = lower.y; y <= upper.y; ++y) {
      for (int x = lower.x; x <= upper.x; ++x) {
        const ivec3 leaf = ivec3(x, y, z);
        addLeaf(leaf, cell, params.cell <= 1.0 && all(lessThanEqual(leaf, last)));
      }
    }
  }
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    field[haloIndex(cell, params.dims, params.group * LPV_CHANNELS + k)] += params.weight[k] * emitted[k];
  }
}
