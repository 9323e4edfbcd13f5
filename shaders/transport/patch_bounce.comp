// One bounce: what arrives at each patch from the lights and from all patches that it sees, by what arrived there one
// bounce before. The last turn of bounces puts what patches then send where receivers look (light_points.glsl). A thread
// has a patch. LPV_PAIR_COLOURS: as in patch_visibility.comp.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchPairs) readonly buffer Pairs { uint pairs[]; };
layout(std430, binding = kPatchLights) writeonly buffer Lights { vec4 lights[]; };

#ifndef LPV_PAIR_COLOURS
#error "LPV_PAIR_COLOURS: 0 or 1"
#endif

vec3 sentBy(int b, vec3 x, vec3 n, int before) {
  return patchWeight(patches[b], x, n) * patches[b].albedo.rgb * patches[b].arriving[before].rgb / kPi;
}

vec3 reflectedTo(int a, int before) {
  const vec3 n = patches[a].normal.xyz, x = patches[a].place.xyz + kShadowOffset * n;
  vec3 sum = vec3(0.0);
#if LPV_PAIR_COLOURS
  for (int b = 0; b < params.count; ++b) {
    const uint share = pairs[a * params.words + b];
    if (share != 0u) sum += unpackedShare(share) * sentBy(b, x, n, before);
  }
#else
  for (int word = 0; word < params.words; ++word) {
    for (uint bits = pairs[a * params.words + word]; bits != 0u; bits &= bits - 1u)
      sum += sentBy(32 * word + findLSB(bits), x, n, before);
  }
#endif
  return sum;
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count) return;
  const int now = params.bounce & 1;
  vec3 e = patches[a].direct.rgb;
  if (params.bounce > 0) e += reflectedTo(a, 1 - now);
  patches[a].arriving[now] = vec4(e, 0.0);
  if (params.bounce < params.lastBounce) return;
  const vec3 radiance = patches[a].albedo.rgb * e / kPi;
  const float brightness = max(max(radiance.r, radiance.g), radiance.b);
  lights[kLightPointTexels * a] = vec4(patches[a].place.xyz, patches[a].place.w * brightness);
  lights[kLightPointTexels * a + 1] = vec4(patches[a].normal.xyz, -patches[a].place.w);
  lights[kLightPointTexels * a + 2] = vec4(brightness > 0.0 ? radiance / brightness : vec3(0.0), -1.0);
}
