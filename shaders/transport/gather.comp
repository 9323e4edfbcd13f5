// GATHER (MATHS.md 3b.3-4): what one light sends to a block of cells. The work-group walks the light's tree depth first;
// a node that is far enough for its size is taken whole, else its children are. Each thread sums for a column of cells.
//
// LPV_TWO_SIDED: the light emits from both sides. LPV_TEXTURED: each VPL has a colour. LPV_SECTORS: where light is in
// layers by direction, the walk is repeated for each, and leaves out what cannot be in it. LPV_SHADOWED: cells get the
// share of it that they see (shaders/transport/cell_visibility.comp).
#include "layout.h"
#include "common/field.glsl"
#include "common/sh.glsl"
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
const int kRoundsPerEntry = 1;
#else
const int kRoundsPerEntry = kSectorRounds;
#endif
const float kBeyondNode = 0.015625;  // cells that a VPL may lie outside its node: what snapping leaves
Arriving sums[kSums];      // one number per cell of the column (kBlockZ is 4)
vec4 closest = vec4(0.0);  // 1 / distance of the nearest VPL
bool lit;                  // whether the sums hold anything; the same in all threads

void add(inout Arriving to, Arriving from, vec4 factor) {
  to.fluence += factor * from.fluence;
  to.x += factor * from.x;
  to.y += factor * from.y;
  to.z += factor * from.z;
}

void addVpl(int at, int sector, vec2 receiver, vec4 depth) {
  const VplEntry v =
      vplEntry(texelFetch(tree, at), texelFetch(tree, at + 1), texelFetch(tree, at + 2), texelFetch(tree, at + 3));
  const vec2 d = v.position.xy - receiver;
  const vec4 dz = v.position.z - depth;
  const Arriving light = arrivingFrom(v, d.x, d.y, dz, LPV_TWO_SIDED == 1);
  closest = max(closest, light.inverseDistance);
#if LPV_SECTORS == LPV_SECTORS_NONE
  const vec4 share = vec4(1.0);
#else
  const vec4 inverse = light.inverseDistance;
  const vec4 share = sectorShare(sector, d.x * inverse, d.y * inverse, dz * inverse);
#endif
#if LPV_TEXTURED
  const vec3 colour = texelFetch(tree, at + 4).rgb;
  for (int k = 0; k < kColours; ++k) add(sums[k], light, share * colour[k]);
#else
  add(sums[0], light, share);
#endif
}

/// Whether light from within `reach` of a place along each axis may be in a sector for some receiver of the block.
bool mayBeIn(int sector, vec3 place, float reach, vec3 lower, vec3 upper) {
#if LPV_SECTORS == LPV_SECTORS_NONE
  return true;
#else
  return sectorReached(sector, place - upper - reach, place - lower + reach);
#endif
}

/// The first of a node's VPLs from `i` on that may be in the sector; beyond `last`: none. A loop of its own: llvmpipe
/// goes through what a branch leaves out, so a VPL passed over there takes as long as one that is summed.
int nextIn(int sector, int i, int last, vec3 lower, vec3 upper) {
#if LPV_SECTORS != LPV_SECTORS_NONE
  while (i <= last && !mayBeIn(sector, texelFetch(tree, i * kEntryTexels).xyz, 0.0, lower, upper)) ++i;
#endif
  return i;
}

/// From entry `at` on; returns where the walk stands when it has done its share.
int walk(int at, int sector, vec2 receiver, vec4 depth, vec3 lower, vec3 upper) {
  const int end = params.entryCount;
  const float reach = params.openingRatio * params.openingRatio;
  for (int rounds = 0; at < end && rounds < kMaxRounds;) {
    const vec4 node = texelFetch(tree, at * kEntryTexels), next = texelFetch(tree, at * kEntryTexels + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec3 gap = max(max(lower - node.xyz, node.xyz - upper), 0.0);
    const bool leaf = after == at + 1 + vpls;
    const bool outside = !mayBeIn(sector, node.xyz, 0.5 * node.w + kBeyondNode, lower, upper);
    const bool whole = leaf || outside || dot(gap, gap) > reach * node.w * node.w;
    const int last = whole && !outside ? at + vpls : at;
    for (int i = nextIn(sector, at + 1, last, lower, upper); i <= last;
         i = nextIn(sector, i + 1, last, lower, upper)) {
      lit = true;
      addVpl(i * kEntryTexels, sector, receiver, depth);
    }
    rounds += kRoundsPerEntry * (1 + last - at);
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
    const int s = min(k, kSums - 1);
    const vec4 light = arrived(cell, vec4(sums[s].x[z], sums[s].y[z], sums[s].z[z], max(sums[s].fluence[z], 0.0)));
    const vec3 flux = light.xyz;
    // A series cut off can give what no light does; only beside nodes taken from too near.
    const float fluence = light.w, possible = fluence / max(length(flux), 1e-30);
    field[haloIndex(cell, params.dims, params.firstChannel + layer * LPV_CHANNELS + k)] +=
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
  const int turn = params.turn;
  const int from = turn > 0 ? int(cursors[block][turn & 1]) : 0;
  const bool inside = cell.x < params.dims.x && cell.y < params.dims.y;
  int to = from;
  for (int sector = params.firstSector; sector < params.sectorsEnd; ++sector) {
    for (int k = 0; k < kSums; ++k) sums[k] = Arriving(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
    lit = false;
    to = walk(from, sector, vec2(cell.xy) + 0.5, float(cell.z) + vec4(0.5, 1.5, 2.5, 3.5), lower, upper);
    if (!inside || !lit) continue;
    for (int z = 0; z < kBlockZ && cell.z + z < params.dims.z; ++z) store(cell + ivec3(0, 0, z), z, sector);
  }
  // Not where the group's other threads may still be about to read.
  if (params.entryCount > kMaxRounds / kRoundsPerEntry && gl_LocalInvocationIndex == 0u) cursors[block][(turn + 1) & 1] = uint(to);
  if (!inside) return;
  for (int z = 0; z < kBlockZ && cell.z + z < params.dims.z; ++z) {
    const int i = cellIndex(cell + ivec3(0, 0, z), params.dims);
    if (closest[z] > 0.0) emitterDistance[i] = min(emitterDistance[i], 1.0 / closest[z]);
  }
}
