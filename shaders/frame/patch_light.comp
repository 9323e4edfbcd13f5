// What the patches of the surfaces reflect to the points that near_field.comp has listed: the last pool of lights
// (shadow_rays.comp). Far patches are patchWeight of visibility/patch_weight.glsl; near ones are the triangles that they
// are. Few are nearer than they are large, and they matter most, beside edges and in folds: each is asked whether it is
// seen, by a ray. Threads per point.
#include "layout.h"
#include "common/sh.glsl"
#include "transport/polygons.glsl"
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"
#include "visibility/patch_sums.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

/// Between normals of surfaces that send each other nothing: of a bowl's light 5e-5 is lost.
const float kBesideCosine = 0.9999;
const int kPlacesOfNear = 8;  // of a patch, that are weighed for its ray

vec3 radianceOf(int i) {
  const float area = -texelFetch(lightPoints, kLightPointTexels * i + 1).w;
  return texelFetch(lightPoints, kLightPointTexels * i).w / area *
         texelFetch(lightPoints, kLightPointTexels * i + 2).rgb;
}

/// What arrives at a point.
struct Arriving {
  vec3 light;   // of what is not asked
  vec3 asked;   // with nothing in between, of what is: near patches by a ray each, folds by rays all around
  vec3 known;   // what of that is known to arrive
  float foldsWithin;  // how far pieces of folds that are asked may be; 0: none are
};

/// Of the patches from `first` to `end`, the far ones' light, and a bit for each of the others: near ones. `sent`: with
/// what all before send, to be added up for rays.
/// What pieces of folds send, which are looked for instead of patches that stand for them (fold_rays.comp), is not known
/// yet: as much is asked for as patches like these send to all sides, so that what they are found to send is smoothed like
/// a share of it.
uint addFar(int first, int end, vec3 x, vec3 n, inout float sent, inout Arriving arriving) {
  uint near = 0u;
  for (int i = first; i < end; ++i) {
    const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
    if (place.w == 0.0) continue;  // dark, as an eighth of a furnished room's are: inside furniture and behind it
    const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
    const vec4 colour = texelFetch(lightPoints, kLightPointTexels * i + 2);
    const vec3 d = place.xyz - x;
    const float r2 = dot(d, d), folded = foldedShare(r2, colour.a);
    const bool far = r2 >= -kNearPatch * emits.w;
    near |= folded > 0.0 || far || dot(emits.xyz, n) > kBesideCosine ? 0u : 1u << (i - first);
    const float weight = place.w * patchWeightPerArea(d, -emits.w, emits.xyz, n);
    arriving.light += far ? (1.0 - folded) * weight * colour.rgb : vec3(0.0);
    sent += shareToAsk(r2, -emits.w, colour.a) * weight;
    arriving.asked += folded * place.w / (r2 - emits.w) * colour.rgb;
    if (folded > 0.0) arriving.foldsWithin = max(arriving.foldsWithin, sqrt(r2) + sqrt(kFromFolds - colour.a));
  }
  return near;
}

/// With nothing in between.
float arrivesFrom(int i, vec3 x, vec3 n) {
  const Patch p = patches[i];
  return p.corners[0].w == 0.0 ? patchWeight(p.place.xyz - x, p.place.w, p.normal.xyz, n)
                               : ownShare(p, x, n) * triangleIrradiance(p.corners[0].xyz - x, p.corners[1].xyz - x, p.corners[2].xyz - x, n, 1.0);
}

/// A place of a patch, of some in proportion to what they would send there, others for another pixel and patch: what is
/// seen of a triangle in part becomes grain, which is smoothed, not a step.
vec3 placeOn(int i, vec3 x, vec3 n, ivec2 pixel) {
  const Patch p = patches[i];
  if (p.corners[0].w == 0.0 || shadow.jitter == 0) return p.place.xyz;
  vec2 at = vec2(pixel & 1023) * vec2(0.7548776662, 0.5698402910) + float(i) * vec2(0.6180339887, 0.3819660113);
  float chance = fract(dot(at, vec2(0.8191725134, 0.6710436067)));
  vec3 place = p.place.xyz;
  float all = 0.0;
  for (int tries = 0; tries < kPlacesOfNear; ++tries) {
    at = fract(at + vec2(0.7548776662, 0.5698402910));
    const vec3 other = ownPlace(p, at);
    const float weight = sentFrom(other - x, p, n);
    all += weight;
    const bool takes = weight > 0.0 && chance * all < weight;
    chance = takes ? chance * all / weight : (chance * all - weight) / max(all - weight, 1e-30);
    place = takes ? other : place;
  }
  return place;
}

/// The share of what a place sends that arrives.
vec3 arrivesOf(vec3 x, vec3 place, inout int rounds) {
  const vec3 share = transmitted(x, mix(x, place, kShadowEnd), kFromSurfaces, rounds);
#if LPV_TRANSPARENT
  return throughHaze(x, place) * share;
#else
  return share;
#endif
}

void addNear(int i, vec3 d, vec3 x, vec3 n, ivec2 pixel, inout int rounds, inout Arriving arriving) {
  const vec3 e = arrivesFrom(i, x, n) * radianceOf(i);
  const bool asks = dot(d, d) < kAskedPatch * patches[i].place.w;
  arriving.light += asks ? vec3(0.0) : e;
  arriving.asked += asks ? e : vec3(0.0);
  if (asks && shadow.turns == 0) arriving.known += e;
  if (asks && shadow.turns > 0 && e != vec3(0.0)) {
    const vec3 place = placeOn(i, x, n, pixel);
    arriving.known += e * sentAt(patches[i], place) * arrivesOf(x, place, rounds);
  }
}

/// Patches by 32: llvmpipe goes through what any of eight points needs, and for near patches that is much.
Arriving arrivingAt(uint point, vec3 x, vec3 n, ivec2 pixel) {
  Arriving arriving = Arriving(vec3(0.0), vec3(0.0), vec3(0.0), 0.0);
  int rounds = 0;
  float sent = 0.0;
  for (int first = 0; first < shadow.pointCount; first += 32) {
    uint near = 0u;
    for (int before = 0; before < 32; before += kLeastPatchBatch) {
      const int begin = min(first + before, shadow.pointCount), end = min(begin + kLeastPatchBatch, shadow.pointCount);
      near |= addFar(begin, end, x, n, sent, arriving) << before;
      keepPatchSum(point, batchOf(max(end - 1, 0)), sent);
    }
    for (; near != 0u; near &= near - 1u) {
      const int i = first + findLSB(near);
      addNear(i, patches[i].place.xyz - x, x, n, pixel, rounds, arriving);
    }
  }
  return arriving;
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const ivec2 pixel = receiverOf(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel);
  const Arriving arriving = arrivingAt(point, rayStart(pixel, n), n, inPicture(pixel));
  begin(point, arriving.light, arriving.asked, arriving.known, arriving.foldsWithin);
}
