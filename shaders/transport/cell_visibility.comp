// How much of one light the cells of the volume see (MATHS.md 3d): rays from their centres to points of the light, four a
// dispatch, chosen in proportion to what each point sends, the same from every cell. A column of cells goes on after the
// first four only if these disagree: elsewhere it is in the light or in the dark. A work-group has a block of cells. Of
// light that comes through a pane cells get the mean of the three colours.
#include "layout.h"
#include "common/field.glsl"
#define LPV_FACING 0
#define LPV_FROM_PATCHES 0
#include "visibility/light_points.glsl"
#include "visibility/occluders.glsl"

layout(local_size_x = kBlockX, local_size_y = kBlockY, local_size_z = kBlockZ) in;

layout(std140, binding = kParams) uniform Block { CellVisibilityParams params; };
layout(std430, binding = kCellVisibility) buffer Visibility { CellVisibility visibility[]; };

shared float firstSeen[kBlockX * kBlockY * kBlockZ];  // of a cell's first rays, how many arrived; -1: none were sent

/// Whether the rays of a column's cells all met the same: the light, or something before it.
bool agreed() {
  if (params.toTheEnd == 1) return false;
  const uint column = gl_LocalInvocationIndex % uint(kBlockX * kBlockY);
  float arrived = 0.0, sent = 0.0;
  for (uint z = 0u; z < uint(kBlockZ); ++z) {
    const float seen = firstSeen[column + z * uint(kBlockX * kBlockY)];
    arrived += max(seen, 0.0);
    sent += seen < 0.0 ? 0.0 : 4.0;
  }
  return arrived == 0.0 || arrived == sent;
}

CellVisibility rays(vec3 x) {
  const int turn = (params.turn + params.turns / 2) % params.turns;  // the first go to the middle of each quarter
  float weight;  // not used: from a cell one turn's points are worth about as much as another's
  const ivec4 chosen =
      chosenPoints(params.firstPoint, params.pointCount, x, vec3(0.0), (float(turn) + 0.5) / float(params.turns),
                   fract(0.5 + 0.6180339887 * float(params.turn)), weight);
  CellVisibility v = CellVisibility(vec4(0.0), vec4(0.0));
  for (int i = 0; i < 4; ++i) {
    if (chosen[i] < 0) continue;
    const vec3 to = texelFetch(lightPoints, kLightPointTexels * chosen[i]).xyz;
    const vec4 ray = vec4(normalize(to - x), 1.0);
    v.all += ray;
    float share = dot(transmitted(x, mix(x, to, kShadowEnd), params.light), vec3(1.0 / 3.0));
#if LPV_TRANSPARENT
    share *= throughHaze(x, to);
#endif
    v.seen += ray * share;
  }
  return v;
}

void main() {
  const int block = params.firstBlock + int(gl_WorkGroupID.x);
  const ivec3 blockAt = ivec3(block % params.blocks.x, block / params.blocks.x % params.blocks.y,
                              block / (params.blocks.x * params.blocks.y));
  const ivec3 cell = blockAt * ivec3(kBlockX, kBlockY, kBlockZ) + ivec3(gl_LocalInvocationID);
  const bool inside = all(lessThan(cell, params.dims));
  const int at = inside ? cellIndex(cell, params.dims) : 0;
  CellVisibility known = CellVisibility(vec4(0.0), vec4(0.0));
  if (inside && params.turn > 0) known = visibility[at];
  firstSeen[gl_LocalInvocationIndex] = inside && known.all.w > 0.0 ? known.seen.w : -1.0;
  barrier();
  const bool stays = params.turn == 1 ? agreed() : params.turn > 1 && known.all.w < 4.0 * float(params.turn);
  if (!inside || stays) return;
  const CellVisibility more = rays(vec3(cell) + 0.5);
  visibility[at] = CellVisibility(known.all + more.all, known.seen + more.seen);
}
