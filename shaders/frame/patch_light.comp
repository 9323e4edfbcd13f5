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

layout(local_size_x = 4 * kNearFieldGroup) in;

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

const int kMostTries = 8;  // to find a place that the receiver does not turn its back to

vec3 radianceOf(int i) {
  const float area = -texelFetch(lightPoints, kLightPointTexels * i + 1).w;
  return texelFetch(lightPoints, kLightPointTexels * i).w / area *
         texelFetch(lightPoints, kLightPointTexels * i + 2).rgb;
}

/// By the square of the distance over the patch's area.
bool isNearer(int i, vec3 x, float limit) {
  const vec3 d = texelFetch(lightPoints, kLightPointTexels * i).xyz - x;
  return dot(d, d) < -limit * texelFetch(lightPoints, kLightPointTexels * i + 1).w;
}

/// Whether its pieces are looked for instead, in fold_rays.comp.
bool isFolded(int i, vec3 x) {
  const vec3 d = texelFetch(lightPoints, kLightPointTexels * i).xyz - x;
  return isFolded(dot(d, d), texelFetch(lightPoints, kLightPointTexels * i + 2).a);
}

vec3 farLight(vec3 x, vec3 n) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < shadow.pointCount; ++i) {
    const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
    const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
    const vec4 colour = texelFetch(lightPoints, kLightPointTexels * i + 2);
    const vec3 d = place.xyz - x;
    const bool near = dot(d, d) < -kNearPatch * emits.w || isFolded(dot(d, d), colour.a);
    sum += near ? vec3(0.0) : place.w * patchWeightPerArea(d, -emits.w, emits.xyz, n) * colour.rgb;
  }
  return sum;
}

/// With nothing in between.
float arrivesFrom(int i, vec3 x, vec3 n) {
  const Patch p = patches[i];
  return p.corners[0].w == 0.0 ? patchWeight(p.place.xyz - x, p.place.w, p.normal.xyz, n)
                               : triangleIrradiance(p.corners[0].xyz - x, p.corners[1].xyz - x, p.corners[2].xyz - x, n, 1.0);
}

/// A place of a patch above the receiver's plane, another one for another pixel and patch: what is seen of a triangle in
/// part becomes grain, which is smoothed, not a step.
vec3 placeOn(int i, vec3 x, vec3 n, ivec2 pixel) {
  const Patch p = patches[i];
  if (p.corners[0].w == 0.0 || shadow.jitter == 0) return p.place.xyz;
  vec2 at = vec2(pixel & 1023) * vec2(0.7548776662, 0.5698402910) + float(i) * vec2(0.6180339887, 0.3819660113);
  vec3 place = p.place.xyz;
  for (int tries = 0; tries < kMostTries; ++tries) {
    at = fract(at + vec2(0.7548776662, 0.5698402910));
    place = mix(p.corners[0].xyz, mix(p.corners[1].xyz, p.corners[2].xyz, at.y), sqrt(at.x));
    if (dot(place - x, n) > 0.0) break;
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

/// Of near patches, what would arrive with nothing in between, from those that are not asked and from those that are;
/// and what arrives from these. What pieces of folds send is not known yet: as much is asked for as patches like these
/// send to all sides, so that what they are found to send is smoothed like a share of it.
void addNear(vec3 x, vec3 n, ivec2 pixel, inout vec3 light, out vec3 asked, out vec3 known, out bool folded) {
  asked = known = vec3(0.0);
  folded = false;
  int i = 0, rounds = 0;
  while (i < shadow.pointCount) {
    // By itself: llvmpipe goes through what a branch leaves out.
    while (i < shadow.pointCount && !isNearer(i, x, kNearPatch) && !isFolded(i, x)) ++i;
    if (i >= shadow.pointCount) break;
    if (isFolded(i, x)) {
      const vec3 d = patches[i].place.xyz - x;
      asked += patches[i].place.w / (dot(d, d) + patches[i].place.w) * radianceOf(i);
      folded = true;
      ++i;
      continue;
    }
    const vec3 e = arrivesFrom(i, x, n) * radianceOf(i);
    const bool asks = isNearer(i, x, kAskedPatch);
    light += asks ? vec3(0.0) : e;
    asked += asks ? e : vec3(0.0);
    if (asks && shadow.turns == 0) known += e;
    if (asks && shadow.turns > 0 && e != vec3(0.0)) known += e * arrivesOf(x, placeOn(i, x, n, inPicture(pixel)), rounds);
    ++i;
  }
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const ivec2 pixel = unpackedPixel(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel), x = rayStart(pixel, n);
  vec3 light = farLight(x, n), asked, known;
  bool folded;
  addNear(x, n, pixel, light, asked, known, folded);
  begin(point, light, asked, known, folded);
}
