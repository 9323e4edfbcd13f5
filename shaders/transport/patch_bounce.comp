// One turn: what arrives at each patch from the lights and from all patches that it sees, by what arrived there one turn
// before; and how far this one goes there from what was there two turns before. The last turn puts what patches then send
// where receivers look (light_points.glsl). A thread has a patch. LPV_TRANSPARENT: patches may see each other through panes.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) readonly buffer Exchange { float exchange[]; };
layout(std430, binding = kPatchSent) buffer Sent { vec4 sent[]; };
layout(std430, binding = kPatchLights) writeonly buffer Lights { vec4 lights[]; };

#ifndef LPV_TRANSPARENT
#error "LPV_TRANSPARENT: 0 or 1"
#elif LPV_TRANSPARENT
layout(std430, binding = kPatchShares) readonly buffer Shares { uint shares[]; };
vec3 shareOf(int pair) { return unpackedShare(shares[pair]); }
#else
vec3 shareOf(int pair) { return vec3(1.0); }
#endif

vec3 reflectedTo(int a, int before) {
  vec3 sum = vec3(0.0);
  for (int b = 0; b < params.count; ++b) {
    const int pair = b * params.count + a;
    sum += shareOf(pair) * max(exchange[pair], 0.0) * sent[before * params.count + b].rgb;
  }
  const float gain = patches[a].of;
  const vec3 own = exchange[a * params.count + a] * sent[before * params.count + a].rgb;
  return patches[a].scale[params.balanced] / patches[a].place.w * (gain * sum + (1.0 - gain) * own);
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count) return;
  const int now = params.bounce & 1;
  vec3 e = patches[a].direct.rgb;
  if (params.bounce > 0) e += reflectedTo(a, 1 - now);
  const vec3 twoBefore = params.bounce > 1 ? patches[a].arriving[now].rgb : vec3(0.0);
  e = twoBefore + params.weight * (e - twoBefore);
  if (params.bounce == params.lastBounce) e = max(e, vec3(0.0));
  patches[a].arriving[now] = vec4(e, 0.0);
  const vec3 radiance = patches[a].albedo.rgb * e / kPi;
  sent[now * params.count + a] = vec4(patches[a].scale[params.balanced] * radiance, 0.0);
  if (params.bounce < params.lastBounce) return;
  const float brightness = max(max(radiance.r, radiance.g), radiance.b);
  lights[kLightPointTexels * a] = vec4(patches[a].place.xyz, patches[a].place.w * brightness);
  lights[kLightPointTexels * a + 1] = vec4(patches[a].normal.xyz, -patches[a].place.w);
  lights[kLightPointTexels * a + 2] = vec4(brightness > 0.0 ? radiance / brightness : vec3(0.0), patches[a].corners[1].w < 0.0 ? kFromFolds - patches[a].corners[2].w : float(kFromSurfaces));
}
