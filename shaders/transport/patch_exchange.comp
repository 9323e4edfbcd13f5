// How much light every two patches exchange (MATHS.md 3d): nothing where a ray from middle to middle meets a surface; where
// some of one is behind others, the share of it that some rays from place to place find. Lights between them are found
// apart (patch_lights.comp). A thread has eight partners of one patch; the lower patch of a pair answers for both.
// LPV_TRANSPARENT: what light keeps through panes and haze on the way is apart.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"
#include "transport/polygons.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) writeonly buffer Exchange { float exchange[]; };

#if LPV_TRANSPARENT
layout(std430, binding = kPatchShares) writeonly buffer Shares { uint shares[]; };
#endif

vec3 beside(Patch p) { return p.place.xyz + kShadowOffset * p.normal.xyz; }

bool faceEachOther(Patch a, Patch b) {
  const vec3 d = beside(b) - beside(a);
  return dot(d, a.normal.xyz) > 0.0 && dot(d, b.normal.xyz) < 0.0;
}

/// At the middle of a patch; from a triangle that is near exactly.
float arrivesAt(Patch at, Patch from) {
  const vec3 x = beside(at), d = from.place.xyz - x;
  if (dot(d, d) > kNearPatch * from.place.w || from.corners[0].w == 0.0) return patchWeight(d, from.place.w, from.normal.xyz, at.normal.xyz);
  return ownShare(from, x, at.normal.xyz) * triangleIrradiance(from.corners[0].xyz - x, from.corners[1].xyz - x,
                                                               from.corners[2].xyz - x, at.normal.xyz, 1.0);
}

/// The share of what one patch sends to another one that arrives, by so many rays.
vec3 arrivesBetween(int a, int b, int rays, inout int rounds) {
  vec3 sum = vec3(0.0);
  int sent = 0;
  for (; sent < rays && (sent == 0 || rounds < kMostRayRounds); ++sent) {
    const vec3 from = placeTowards(a, b, sent), to = placeTowards(b, a, sent);
    int own = 0;
    vec3 share = transmitted(from, to, kAllLights, own);
    rounds += own;
#if LPV_TRANSPARENT
    share *= throughHaze(from, to);
#endif
    sum += share;
  }
  return sum / float(sent);
}

void main() {
  const int eights = (params.count + 7) / 8, index = params.first + int(gl_GlobalInvocationID.x);
  const int a = index / eights, begin = 8 * (index % eights);
  if (a >= params.count || begin + 7 <= a) return;
  const Patch here = patches[a];
  int rounds = 0;
  for (int b = max(begin, a + 1); b < min(begin + 8, params.count); ++b) {
    const Patch there = patches[b];
    if (!faceEachOther(here, there)) continue;
    const vec3 share = arrivesBetween(a, b, isUneven(here) || isUneven(there) ? kRaysOfUneven : 1, rounds);
    if (share == vec3(0.0)) continue;
#if LPV_TRANSPARENT
    const uint kept = packedShare(share);
    shares[b * params.stride + a] = kept;
    shares[a * params.stride + b] = kept;
#endif
    const float seen = LPV_TRANSPARENT == 1 ? 1.0 : share.r;
    exchange[b * params.stride + a] = seen * here.place.w * arrivesAt(here, there);
    exchange[a * params.stride + b] = seen * there.place.w * arrivesAt(there, here);
  }
}
