// GATHER (MATHS.md 3b.3-4): what one light sends to a block of cells. The work-group walks the light's tree depth first;
// a node that is far enough for its size is taken whole, else its children are. Each thread sums for a column of cells.
//
// LPV_TWO_SIDED: the light emits from both sides. LPV_TEXTURED: each VPL has a colour. LPV_SECTORS: light is in layers by
// the direction that it comes from, node by node. LPV_SHADOWED: cells get the share of it that they see
// (shaders/transport/cell_visibility.comp).
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"
#include "transport/receiver_block.glsl"
#include "transport/vpls.glsl"
#define LPV_RECEIVERS 4
#include "transport/vpl_kernel.glsl"

#ifndef LPV_SECTORS
#error "LPV_SECTORS: LPV_SECTORS_.. (shaders/layout.h)"
#elif LPV_SECTORS != LPV_SECTORS_NONE
#include "transport/sectors.glsl"
#endif
#ifndef LPV_SHADOWED
#error "LPV_SHADOWED: 0 or 1"
#endif
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
#if LPV_SHADOWED
layout(std430, binding = kCellVisibility) readonly buffer Visibility { CellVisibility visibility[]; };
#endif

#if LPV_TEXTURED
const int kSums = kColours;
#else
const int kSums = 1;
#endif
#if LPV_SECTORS == LPV_SECTORS_NONE
const int kLayers = 1;
#else
const int kLayers = kSectors;
#endif
/// Of one number per cell of the column (kBlockZ is 4).
struct Light {
  vec4 fluence;
  vec4 x, y, z;  // vector irradiance
};
const Light kDark = Light(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
Light sums[kLayers * kSums];
Light ofNode[kSums];       // what a node's VPLs send
vec4 closest = vec4(0.0);  // 1 / distance of the nearest VPL

void addVpl(int at, vec2 receiver, vec4 depth) {
  const VplEntry v =
      vplEntry(texelFetch(tree, at), texelFetch(tree, at + 1), texelFetch(tree, at + 2), texelFetch(tree, at + 3));
  const Arriving light =
      arrivingFrom(v, v.position.x - receiver.x, v.position.y - receiver.y, v.position.z - depth, LPV_TWO_SIDED == 1);
  closest = max(closest, light.inverseDistance);
#if LPV_TEXTURED
  const vec3 colour = texelFetch(tree, at + 4).rgb;
#else
  const vec3 colour = vec3(1.0);
#endif
  for (int k = 0; k < kSums; ++k) {
    ofNode[k].fluence += colour[k] * light.fluence;
    ofNode[k].x += colour[k] * light.x;
    ofNode[k].y += colour[k] * light.y;
    ofNode[k].z += colour[k] * light.z;
  }
}

/// To the sums; where layers are by direction, to each its share by the direction that the node's light as a whole
/// comes from.
void addNode() {
  for (int k = 0; k < kSums; ++k) {
    const Light light = ofNode[k];
#if LPV_SECTORS == LPV_SECTORS_NONE
    const vec4 shares[kLayers] = vec4[](vec4(1.0));
#else
    const vec4 inverse = inversesqrt(max(light.x * light.x + light.y * light.y + light.z * light.z, 1e-30));
    const vec4 shares[kLayers] = sectorShares(inverse * light.x, inverse * light.y, inverse * light.z);
#endif
    for (int layer = 0; layer < kLayers; ++layer) {
      const vec4 share = shares[layer];
      sums[layer * kSums + k].fluence += share * light.fluence;
      sums[layer * kSums + k].x += share * light.x;
      sums[layer * kSums + k].y += share * light.y;
      sums[layer * kSums + k].z += share * light.z;
    }
    ofNode[k] = kDark;
  }
}

/// From entry `at` on; returns where the walk stands when it has done its share.
int walk(int at, vec2 receiver, vec4 depth, vec3 lower, vec3 upper) {
  const int end = params.entryCount;
  const float reach = params.openingRatio * params.openingRatio;
  for (int rounds = 0; at < end && rounds < kMaxRounds;) {
    const vec4 node = texelFetch(tree, at * kEntryTexels), next = texelFetch(tree, at * kEntryTexels + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec3 gap = max(max(lower - node.xyz, node.xyz - upper), 0.0);
    const bool leaf = after == at + 1 + vpls;
    const bool whole = leaf || dot(gap, gap) > reach * node.w * node.w;
    const int last = whole ? at + vpls : at;
    for (int i = at + 1; i <= last; ++i) addVpl(i * kEntryTexels, receiver, depth);
    addNode();
    rounds += 1 + last - at;
    at = whole ? after : at + 1 + vpls;
  }
  return at;
}

/// What arrives of fluence and vector irradiance (in xyz and w). Rays stand for equal shares of the fluence, and where
/// they came from moves the direction: the difference of two estimates with the same rays, so that light that nothing
/// hides stays exact.
vec4 arrived(ivec3 cell, vec4 light) {
#if LPV_SHADOWED
  const CellVisibility v = visibility[cellIndex(cell, params.dims)];
  if (v.seen.w >= v.all.w) return light;
  const float share = v.seen.w / v.all.w;
#if LPV_SECTORS == LPV_SECTORS_NONE
  const vec3 aside = light.w / v.all.w * (v.seen.xyz - share * v.all.xyz);
#else
  const vec3 aside = vec3(0.0);  // between sectors
#endif
  return vec4(share * light.xyz + aside, share * light.w);
#else
  return light;
#endif
}

void store(ivec3 cell, int z, int layer) {
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    if (params.weight[k] == 0.0) continue;  // uniform: a light of another chromaticity
    const int s = layer * kSums + min(k, kSums - 1);
    const vec4 light = arrived(cell, vec4(sums[s].x[z], sums[s].y[z], sums[s].z[z], max(sums[s].fluence[z], 0.0)));
    const vec3 flux = light.xyz;
    // A series cut off can give what no light does; only beside nodes taken from too near.
    const float fluence = light.w, possible = fluence / max(length(flux), 1e-30);
    const vec4 sent = params.weight[k] * vec4(kY0 * fluence, kY1 * min(possible, 1.0) * flux.yzx);
    for (int target = 0; target < params.targets; ++target) {
      field[haloIndex(cell, params.dims, params.firstChannel[target] + layer * LPV_CHANNELS + k)] +=
          params.share[target] * sent;
    }
  }
}

void main() {
  const uint block = params.firstBlock + gl_WorkGroupID.x;
  const ivec3 first = firstCellOf(blocks[block]);
  const ivec3 cell = first + ivec3(gl_LocalInvocationID.xy, 0);
  const vec3 lower = vec3(first) + 0.5;
  const vec3 upper = min(lower + vec3(kBlockX, kBlockY, kBlockZ) - 1.0, vec3(params.dims) - 0.5);
  const int turn = params.turn;
  const int from = turn > 0 ? int(cursors[block][turn & 1]) : 0;
  const bool inside = cell.x < params.dims.x && cell.y < params.dims.y;
  for (int i = 0; i < kLayers * kSums; ++i) sums[i] = kDark;
  for (int k = 0; k < kSums; ++k) ofNode[k] = kDark;
  const int to = walk(from, vec2(cell.xy) + 0.5, float(cell.z) + vec4(0.5, 1.5, 2.5, 3.5), lower, upper);
  for (int layer = 0; layer < kLayers; ++layer) {
    // Where no light is, the loop has no rounds: llvmpipe would go through what a branch leaves out.
    bvec4 lit = bvec4(false);
    for (int k = 0; k < kSums; ++k) {
      const vec4 fluence = sums[layer * kSums + k].fluence;
      lit = bvec4(lit.x || fluence.x > 0.0, lit.y || fluence.y > 0.0, lit.z || fluence.z > 0.0, lit.w || fluence.w > 0.0);
    }
    for (int z = inside && any(lit) ? 0 : kBlockZ; z < kBlockZ && cell.z + z < params.dims.z; ++z) {
      store(cell + ivec3(0, 0, z), z, layer);
    }
  }
  // Not where the group's other threads may still be about to read.
  if (params.entryCount > kMaxRounds && gl_LocalInvocationIndex == 0u) cursors[block][(turn + 1) & 1] = uint(to);
  if (!inside) return;
  for (int z = 0; z < kBlockZ && cell.z + z < params.dims.z; ++z) {
    const int i = cellIndex(cell + ivec3(0, 0, z), params.dims);
    if (closest[z] > 0.0) emitterDistance[i] = min(emitterDistance[i], 1.0 / closest[z]);
  }
}
