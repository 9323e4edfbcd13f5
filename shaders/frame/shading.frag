// Deferred shading: a pixel is the emission of a light in front, else albedo E / pi, else black. LPV_DISPLAY: exposed,
// through the tone curve, for 8 bits; else linear radiance, with 1 in alpha where a surface is seen.
#include "layout.h"
#include "common/sh.glsl"
#include "common/octahedral.glsl"
#include "transport/lookup.glsl"
#include "common/tonemap.glsl"

#ifndef LPV_DISPLAY
#error "LPV_DISPLAY: 0 or 1"
#endif
// LPV_DIRECT: where receivers look at the lights themselves: 0 nowhere, 1 beyond the grid, 2 near emitters too, 3
// everywhere.
#ifndef LPV_DIRECT
#error "LPV_DIRECT: 0, 1, 2 or 3"
#endif
#if LPV_DIRECT
#include "transport/emitter_list.glsl"
#endif
#if LPV_DIRECT == 2
layout(binding = kEmitterDistance) uniform sampler3D emitterDistance;
#endif

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(binding = kAlbedo) uniform sampler2D albedo;
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmission) uniform sampler2D emission;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;

layout(location = 0) out vec4 colour;

/// Grid position of what is seen in this pixel at a stored depth.
vec3 gridPosition(float depth) {
  const vec2 uv = gl_FragCoord.xy * frame.depth.zw;
  const vec3 ray = frame.rayOrigin.xyz + uv.x * frame.rayRight.xyz + uv.y * frame.rayDown.xyz;
  return frame.eye.xyz + frame.depth.x / (depth + frame.depth.y) * ray;
}

#if LPV_DIRECT == 1 || LPV_DIRECT == 2
/// As in server/scene/emitter_list.h.
float farFromEmitters(vec3 p) {
  const vec3 dims = vec3(frame.dims.xyz);
  if (any(lessThan(p, vec3(-0.5))) || any(greaterThan(p, dims + 0.5))) return 0.0;
#if LPV_DIRECT == 1
  return 1.0;
#else
  return smoothstep(kNearFieldBegin, kNearFieldEnd, textureLod(emitterDistance, p / dims, 0.0).x);
#endif
}
#endif

vec3 irradiance(vec3 p, vec3 n) {
#if LPV_DIRECT == 3
  return directIrradiance(p, n);
#else
  const vec3 e = irradianceAt(p, n, frame.dims.xyz, frame.palette.rgb);
#if LPV_DIRECT == 1 || LPV_DIRECT == 2
  const float far = farFromEmitters(p);
  if (far < 1.0) return mix(directIrradiance(p, n), e, far);
#endif
  return e;
#endif
}

vec3 reflected(ivec2 pixel, float depth) {
  const vec3 n = unitFromOctahedral(texelFetch(normal, pixel, 0).xy);
  const vec3 e = irradiance(gridPosition(depth), n);
  return texelFetch(albedo, pixel, 0).rgb * e / kPi;
}

void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  const float surface = texelFetch(surfaceDepth, pixel, 0).x;
  const float emitter = texelFetch(emitterDepth, pixel, 0).x;  // reversed: larger is nearer, 0 is nothing
  colour = vec4(0.0);
  if (emitter > 0.0 && emitter >= surface) {
    colour.rgb = texelFetch(emission, pixel, 0).rgb;
  } else if (surface > 0.0) {
    colour = vec4(reflected(pixel, surface), 1.0);
  }
#if LPV_DISPLAY
  colour = vec4(displayFromRadiance(colour.rgb, frame.exposure.x), 1.0);
#endif
}
