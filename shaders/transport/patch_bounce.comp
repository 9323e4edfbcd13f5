// One turn: what arrives at each patch from the lights and from all patches that it sees, by what arrived there one turn
// before; and how far this one goes there from what was there two turns before. The last turn puts what patches then send
// where receivers look (light_points.glsl). A thread has kPatchRows patches, which share what is read of the others.
// LPV_TRANSPARENT: patches may see each other through panes.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(binding = kPatchExchangeTexels) uniform samplerBuffer exchange;
layout(binding = kPatchSentTexels) uniform samplerBuffer sentBefore;
layout(std430, binding = kPatchSent) writeonly buffer Sent { vec4 sent[]; };
layout(std430, binding = kPatchLights) writeonly buffer Lights { vec4 lights[]; };

#ifndef LPV_TRANSPARENT
#error "LPV_TRANSPARENT: 0 or 1"
#elif LPV_TRANSPARENT
layout(std430, binding = kPatchShares) readonly buffer Shares { uint shares[]; };
vec3 shareOf(int b, int a) { return unpackedShare(shares[b * params.stride + a]); }
#else
vec3 shareOf(int b, int a) { return vec3(1.0); }
#endif

/// What all others reflect to the four patches from `first` on, a column each.
mat4x3 reflectedTo(int first, int before) {
  mat4x3 sums = mat4x3(0.0);
  for (int b = 0; b < params.count; ++b) {
    const vec3 from = texelFetch(sentBefore, before * params.count + b).rgb;
    const vec4 part = max(texelFetch(exchange, (b * params.stride + first) / kPatchRows), vec4(0.0));
    for (int k = 0; k < kPatchRows; ++k) sums[k] += part[k] * shareOf(b, first + k) * from;
  }
  return sums;
}

/// What comes to a patch from all, itself too, of what others reflect to it.
vec3 arrivingAt(int a, int before, vec3 fromOthers) {
  const float gain = patches[a].of;
  const float toItself = texelFetch(exchange, (a * params.stride + a) / kPatchRows)[a % kPatchRows];
  const vec3 own = toItself * texelFetch(sentBefore, before * params.count + a).rgb;
  return patches[a].scale[params.balanced] / patches[a].place.w * (gain * fromOthers + (1.0 - gain) * own);
}

void finish(int a, vec3 fromOthers) {
  const int now = params.bounce & 1;
  vec3 e = patches[a].slope.w * patches[a].direct.rgb;
  if (params.bounce > 0) e += arrivingAt(a, 1 - now, fromOthers);
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

void main() {
  const int first = kPatchRows * (params.first + int(gl_GlobalInvocationID.x));
  if (first >= params.count) return;
  const mat4x3 sums = params.bounce > 0 ? reflectedTo(first, 1 - (params.bounce & 1)) : mat4x3(0.0);
  for (int k = 0; k < kPatchRows; ++k) {
    if (first + k < params.count) finish(first + k, sums[k]);
  }
}
