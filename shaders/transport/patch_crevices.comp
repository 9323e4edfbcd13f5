// What a patch that stands for several small triangles reflects to itself. What it sees nearer than it is large, and not
// in its partners, is its own folds and those of its neighbours: they are taken to be lit as it is, with the mean of the
// albedos around. In the frame of a window half of what is reflected goes on between its parts, and a room is lit by that.
// Rays from the middle say how much of what it sees is so near. A thread per patch.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) buffer Exchange { float exchange[]; };

const float kGoldenAngle = 2.3999632;

/// The k-th of directions about n that are spread by their cosine: a spiral over the disc below them (Vogel 1979).
vec3 directionAbout(vec3 n, int k) {
  const float r2 = (float(k) + 0.5) / float(kCreviceRays), turn = kGoldenAngle * float(k);
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0)));
  return sqrt(r2) * (cos(turn) * right + sin(turn) * cross(n, right)) + sqrt(1.0 - r2) * n;
}

float brightness(vec3 colour) { return dot(colour, vec3(1.0 / 3.0)); }

/// The share of what x sees that is nearer than `reach`, and blocks light.
float coverage(vec3 x, vec3 n, float reach) {
  float open = 0.0;
  int rays = 0, rounds = 0;
  for (; rays < kCreviceRays && rounds < kMostRayRounds; ++rays)
    open += brightness(transmitted(x, x + reach * directionAbout(n, rays), kAllLights, rounds));
  return 1.0 - open / float(rays);
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count || patches[a].corners[0].w > 0.0) return;
  const vec3 n = patches[a].normal.xyz, x = patches[a].place.xyz + kShadowOffset * n;
  const float area = patches[a].place.w, reach = sqrt(area);
  float near = 0.0, all = 0.0, areaAround = 0.0, reflecting = 0.0;
  for (int b = 0; b < params.count; ++b) {
    const float part = exchange[b * params.count + a];
    all += part;
    if (distance(patches[b].place.xyz, x) >= reach) continue;
    near += part;
    areaAround += patches[b].place.w;
    reflecting += patches[b].place.w * brightness(patches[b].albedo.rgb);
  }
  const float whole = kPi * area, own = clamp(whole * coverage(x, n, reach) - near, 0.0, max(whole - all, 0.0));
  const float around = reflecting / areaAround / max(brightness(patches[a].albedo.rgb), 1e-6);
  exchange[a * params.count + a] = own * min(around, 1.0);
}
