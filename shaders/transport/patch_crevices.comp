// What a patch sees of surfaces, by rays from places of it: of all that reflects, and of what is nearer than the patch is
// large. What one that stands for several small triangles sees so near, and not in its partners, is its own folds and those
// of its neighbours: they are taken to be lit as it is, with the mean of the albedos around. In the frame of a window half of
// what is reflected goes on between its parts, and a room is lit by that. Of a triangle, some may be behind a shelf: what
// sees much of the room is lit by it and is seen from it, so it has that part's light, not the mean. A thread per patch.
// LPV_STEP 0: what rays meet; 1: what a patch sends itself, by that and by what it exchanges with others.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"
#include "visibility/patches.glsl"

#ifndef LPV_STEP
#error "LPV_STEP: 0 or 1"
#endif

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) buffer Exchange { float exchange[]; };
#if LPV_TRANSPARENT
layout(std430, binding = kPatchShares) writeonly buffer Shares { uint shares[]; };
#endif

const float kGoldenAngle = 2.3999632;
const int kRaysOfPlace = kCreviceRays / kPatchPlaces;

/// The k-th of directions about n that are spread by their cosine: a spiral over the disc below them (Vogel 1979).
vec3 directionAbout(vec3 n, int k) {
  const float r2 = (float(k) + 0.5) / float(kCreviceRays), turn = kGoldenAngle * float(k);
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  return sqrt(r2) * (cos(turn) * right + sin(turn) * cross(n, right)) + sqrt(1.0 - r2) * n;
}

vec3 placeOf(Patch p, int place) {
  return (p.corners[0].w == 0.0 ? p.place.xyz : placeAt(p, place)) + kShadowOffset * p.normal.xyz;
}

float brightness(vec3 colour) { return dot(colour, vec3(1.0 / 3.0)); }

/// What rays meet.
struct Seen {
  float reflecting;  // the share of them that meet what reflects
  float near;  // and that meet something nearer than the patch is large
  float rays;
  float openness;  // of what its places see further away: the mean of the squares over the square of the mean
};

/// Of the rays from one place: how many meet what reflects, what is nearer than `size`, and than half of it.
ivec3 metFrom(Patch p, int place, float size, inout int rounds) {
  const float beyond = 2.0 * distance(lowestOccluder(), highestOccluder());
  const vec3 x = placeOf(p, place);
  ivec3 met = ivec3(0);
  for (int k = 0; k < kRaysOfPlace; ++k) {
    const Sight sight = firstHit(x, x + beyond * directionAbout(p.normal.xyz, k * kPatchPlaces + place), false, rounds);
    const float at = sight.at < 1.0 ? sight.at * beyond : 2.0 * size;
    met += ivec3(reflects(sight), at < size, at < 0.5 * size);
  }
  return met;
}

/// From each of its places in turn some rays of the spiral, so that each has rays of all heights.
Seen seenFrom(Patch p, float size) {
  ivec3 met = ivec3(0);
  int places = 0, rounds = 0;
  float squares = 0.0;
  for (uint left = p.corners[0].w == 0.0 ? kAllPlaces : uint(p.normal.w); left != 0u && (places == 0 || rounds < kMostRayRounds); left &= left - 1u, ++places) {
    const ivec3 here = metFrom(p, findLSB(left), size, rounds);
    const int open = kRaysOfPlace - here.z;
    met += here;
    squares += float(open * (open - 1)) / float(kRaysOfPlace * (kRaysOfPlace - 1));  // by pairs of rays, so chance adds nothing
  }
  const float rays = float(places * kRaysOfPlace), open = rays - float(met.z), mean = open / rays;
  const float openness = squares / (float(places) * max(mean * mean, 1e-12));
  return Seen(float(met.x) / rays, float(met.y) / rays, rays, clamp(openness, 1.0, float(places)));
}

/// What chance may have added is no light. Rays that are spread evenly leave half of what independent ones would.
float withoutChance(Seen seen) {
  return max(seen.reflecting - 0.5 * sqrt(seen.reflecting * (1.0 - seen.reflecting) / seen.rays), 0.0);
}

/// To a patch from itself; `near`: of what it sees.
float shareOfItself(int a, vec3 x, float reach, float near) {
  float nearer = 0.0, all = 0.0, areaAround = 0.0, reflecting = 0.0;
  for (int b = 0; b < params.count; ++b) {
    const float part = exchange[b * params.stride + a];
    all += part;
    if (distance(patches[b].place.xyz, x) >= reach) continue;
    nearer += part;
    areaAround += patches[b].place.w;
    reflecting += patches[b].place.w * brightness(patches[b].albedo.rgb);
  }
  const float whole = kPi * patches[a].place.w;
  const float around = reflecting / areaAround / max(brightness(patches[a].albedo.rgb), 1e-6);
  return min(around, 1.0) * clamp(whole * near - nearer, 0.0, max(whole - all, 0.0));
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count) return;
  const bool isTriangle = patches[a].corners[0].w != 0.0;
  const float area = patches[a].place.w, size = sqrt(area);
#if LPV_STEP == 0
  const Seen seen = seenFrom(patches[a], size);
  patches[a].of = kPi * area * withoutChance(seen);
  patches[a].wanted = seen.near;
  patches[a].slope = vec4(vec3(0.0), isTriangle ? seen.openness : 1.0);
#else
#if LPV_TRANSPARENT
  shares[a * params.stride + a] = packedShare(vec3(1.0));
#endif
  if (!isTriangle) exchange[a * params.stride + a] = shareOfItself(a, patches[a].place.xyz, size, patches[a].wanted);
#endif
}
