// GATHER (MATHS.md 3b.3-4): what one light sends to a block of cells. The work-group walks the light's tree depth first;
// a node that is far enough for its size is taken whole, else its children are. Each thread sums for a column of cells.
//
// LPV_TWO_SIDED: the light emits from both sides. LPV_TEXTURED: each VPL has a colour.
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"
#include "transport/vpls.glsl"

#ifndef LPV_TWO_SIDED
#error "LPV_TWO_SIDED: 0 or 1"
#endif

layout(local_size_x = kBlockX, local_size_y = kBlockY) in;

layout(std140, binding = kParams) uniform Block { GatherParams params; };
layout(binding = kTree) uniform samplerBuffer tree;
layout(std430, binding = kReceiverBlocks) readonly buffer Blocks { uint blocks[]; };
layout(std430, binding = kCursors) buffer Cursors { uvec2 cursors[]; };
layout(std430, binding = kFieldOut) buffer Field { vec4 field[]; };
layout(std430, binding = kEmitterDistanceBuffer) buffer EmitterDistance { float emitterDistance[]; };

/// Fluence and vector irradiance of the cells of a column, one per component (kBlockZ is 4).
struct Column {
  vec4 fluence, x, y, z;
};

#if LPV_TEXTURED
const int kSums = 3;
#else
const int kSums = 1;
#endif
Column sums[kSums];
vec4 closest = vec4(0.0);  // 1 / distance of the nearest VPL

void add(inout Column to, Column from, float factor) {
  to.fluence += factor * from.fluence;
  to.x += factor * from.x;
  to.y += factor * from.y;
  to.z += factor * from.z;
}

const float kNearest = 1e-3;     // cells: where the direction towards a VPL is lost
const float kFurthestIn = 2.0;   // 1 / r is cut at half a cell

/// What vpls.glsl describes, expanded to second order: with K the kernel of a flat emitter, N.d d / r^4 (fluence: N.d /
/// r^3), K + slope / 2 extent : grad grad K, where slope is how much of the emitter faces the receiver.
void addVpl(int at, vec2 receiver, vec4 depth) {
  const vec4 first = texelFetch(tree, at), second = texelFetch(tree, at + 1);
  const vec4 diagonal = texelFetch(tree, at + 2), others = texelFetch(tree, at + 3);
  const vec2 across = first.xy - receiver;
  const vec4 along = first.z - depth;
  const vec4 inverse = inversesqrt(max(dot(across, across) + along * along, kNearest * kNearest));
  closest = max(closest, inverse);
  const vec4 away = dot(second.xy, across) + second.z * along;
  const vec4 facing = -away * inverse;
  const float spread = second.w;
  const vec4 within = clamp(facing, -spread, spread);
#if LPV_TWO_SIDED
  const vec4 intensity = (within * within + spread * spread) / (2.0 * spread) + max(abs(facing) - spread, 0.0);
  const vec4 slope = within / spread;
#else
  const vec4 intensity = (within + spread) * (within + spread) / (4.0 * spread) + max(facing - spread, 0.0);
  const vec4 slope = (within + spread) / (2.0 * spread);
#endif
  const vec4 near = min(inverse, kFurthestIn), falloff = near * near;

  const vec4 mx = diagonal.x * across.x + others.x * across.y + others.y * along;  // extent d
  const vec4 my = others.x * across.x + diagonal.y * across.y + others.z * along;
  const vec4 mz = others.y * across.x + others.z * across.y + diagonal.z * along;
  const vec3 bent = vec3(diagonal.x * second.x + others.x * second.y + others.y * second.z,  // extent N
                         others.x * second.x + diagonal.y * second.y + others.z * second.z,
                         others.y * second.x + others.z * second.y + diagonal.z * second.z);
  const vec4 skew = dot(bent.xy, across) + bent.z * along;
  const vec4 depths = falloff * (mx * across.x + my * across.y + mz * along);
  const vec4 x = kSteadiness * diagonal.w * falloff, x2 = x * x;
  const vec4 weight = slope * falloff * falloff / (1.0 + x2 * x2);
  const vec4 fluence =
      intensity * falloff + weight * near * (3.0 * skew + away * (1.5 * diagonal.w - 7.5 * depths));
  const vec4 radial =
      intensity * falloff * inverse + weight * falloff * (4.0 * skew + away * (2.0 * diagonal.w - 12.0 * depths));
  const vec4 oblique = 4.0 * weight * falloff * away;
  const Column sum = Column(fluence, radial * across.x + oblique * mx - weight * bent.x,
                            radial * across.y + oblique * my - weight * bent.y,
                            radial * along + oblique * mz - weight * bent.z);
#if LPV_TEXTURED
  const vec3 colour = texelFetch(tree, at + 4).rgb;
  for (int k = 0; k < 3; ++k) add(sums[k], sum, colour[k]);
#else
  add(sums[0], sum, 1.0);
#endif
}

/// From record `at` on; returns where the walk stands when it has done its share.
int walk(int at, vec2 receiver, vec4 depth, vec3 lower, vec3 upper) {
  const int end = params.entryCount;
  const float reach = params.openingRatio * params.openingRatio;
  for (int rounds = 0; at < end && rounds < kMaxRounds;) {
    const vec4 node = texelFetch(tree, at * kRecordTexels), next = texelFetch(tree, at * kRecordTexels + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec3 gap = max(max(lower - node.xyz, node.xyz - upper), 0.0);
    const bool leaf = after == at + 1 + vpls;
    const bool whole = leaf || dot(gap, gap) > reach * node.w * node.w;
    const int last = whole ? at + vpls : at;
    for (int i = at + 1; i <= last; ++i) addVpl(i * kRecordTexels, receiver, depth);
    rounds += 1 + last - at;
    at = whole ? after : at + 1 + vpls;
  }
  return at;
}

void store(ivec3 cell, int z) {
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    if (params.weight[k] == 0.0) continue;  // uniform: a light of another chromaticity
    const int s = min(k, kSums - 1);
    const vec3 flux = vec3(sums[s].x[z], sums[s].y[z], sums[s].z[z]);
    // A series cut off can give what no light does; only beside nodes taken from too near.
    const float fluence = max(sums[s].fluence[z], 0.0), possible = fluence / max(length(flux), 1e-30);
    field[haloIndex(cell, params.dims, params.firstChannel + k)] +=
        params.weight[k] * vec4(kY0 * fluence, kY1 * min(possible, 1.0) * flux.yzx);
  }
}

/// The inverse of packedBlock().
ivec3 unpackedBlock(uint block) {
  const uint mask = (1u << kBlockBits) - 1u;
  return ivec3(block & mask, (block >> kBlockBits) & mask, block >> (2 * kBlockBits));
}

void main() {
  const uint block = params.firstBlock + gl_WorkGroupID.x;
  const uint corner = blocks[block];
  const ivec3 first = unpackedBlock(corner) * ivec3(kBlockX, kBlockY, kBlockZ);
  const ivec3 cell = first + ivec3(gl_LocalInvocationID.xy, 0);
  const vec3 lower = vec3(first) + 0.5;
  const vec3 upper = min(lower + vec3(kBlockX, kBlockY, kBlockZ) - 1.0, vec3(params.dims) - 0.5);
  for (int k = 0; k < kSums; ++k) sums[k] = Column(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  const int turn = params.turn;
  const int from = turn > 0 ? int(cursors[block][turn & 1]) : 0;
  const int to = walk(from, vec2(cell.xy) + 0.5, float(cell.z) + vec4(0.5, 1.5, 2.5, 3.5), lower, upper);
  // Not where the group's other threads may still be about to read.
  if (params.entryCount > kMaxRounds && gl_LocalInvocationIndex == 0u) cursors[block][(turn + 1) & 1] = uint(to);
  if (cell.x >= params.dims.x || cell.y >= params.dims.y) return;
  for (int z = 0; z < kBlockZ && cell.z + z < params.dims.z; ++z) {
    store(cell + ivec3(0, 0, z), z);
    const int i = cellIndex(cell + ivec3(0, 0, z), params.dims);
    if (closest[z] > 0.0) emitterDistance[i] = min(emitterDistance[i], 1.0 / closest[z]);
  }
}
