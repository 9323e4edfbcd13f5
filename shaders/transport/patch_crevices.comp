// What a patch sees of surfaces, by rays from its middle: of all that reflects, and of what is nearer than the patch is
// large. What one that stands for several small triangles sees so near, and not in its partners, is its own folds and those of
// its neighbours: they are taken to be lit as it is, with the mean of the albedos around. In the frame of a window half of
// what is reflected goes on between its parts, and a room is lit by that. A thread per patch.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) buffer Exchange { float exchange[]; };
#if LPV_TRANSPARENT
layout(std430, binding = kPatchShares) writeonly buffer Shares { uint shares[]; };
#endif

const float kGoldenAngle = 2.3999632;

/// The k-th of directions about n that are spread by their cosine: a spiral over the disc below them (Vogel 1979).
vec3 directionAbout(vec3 n, int k) {
  const float r2 = (float(k) + 0.5) / float(kCreviceRays), turn = kGoldenAngle * float(k);
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  return sqrt(r2) * (cos(turn) * right + sin(turn) * cross(n, right)) + sqrt(1.0 - r2) * n;
}

float brightness(vec3 colour) { return dot(colour, vec3(1.0 / 3.0)); }

/// Shares of the rays from x.
struct Seen {
  float all;   // meet what reflects
  float near;  // meet something within `reach`
  float rays;
};

Seen seenFrom(vec3 x, vec3 n, float reach) {
  const float far = 2.0 * distance(lowestOccluder(), highestOccluder());
  int reflecting = 0, near = 0, rays = 0, rounds = 0;
  for (; rays < kCreviceRays && rounds < kMostRayRounds; ++rays) {
    const Sight sight = firstHit(x, x + far * directionAbout(n, rays), false, rounds);
    reflecting += int(reflects(sight));
    near += int(sight.at < 1.0 && sight.at * far < reach);
  }
  return Seen(float(reflecting) / float(rays), float(near) / float(rays), float(rays));
}

/// What chance may have added is no light. Rays that are spread evenly leave half of what independent ones would.
float withoutChance(Seen seen) { return max(seen.all - 0.5 * sqrt(seen.all * (1.0 - seen.all) / seen.rays), 0.0); }

/// To a patch from itself; `near`: of what it sees.
float ownShare(int a, vec3 x, float reach, float near) {
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
  const vec3 n = patches[a].normal.xyz, x = patches[a].place.xyz + kShadowOffset * n;
  const float area = patches[a].place.w, reach = sqrt(area);
  const Seen seen = seenFrom(x, n, reach);
  patches[a].of = kPi * area * withoutChance(seen);
#if LPV_TRANSPARENT
  shares[a * params.stride + a] = packedShare(vec3(1.0));
#endif
  if (patches[a].corners[0].w == 0.0) exchange[a * params.stride + a] = ownShare(a, x, reach, seen.near);
}
