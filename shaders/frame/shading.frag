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
// LPV_NEAR_FIELD: where receivers evaluate the lights themselves.
#ifndef LPV_NEAR_FIELD
#error "LPV_NEAR_FIELD: LPV_NEAR_FIELD_NOWHERE, _OUTSIDE, _EMITTERS or _EVERYWHERE (shaders/layout.h)"
#endif
#if LPV_NEAR_FIELD != LPV_NEAR_FIELD_NOWHERE
#include "transport/emitter_list.glsl"
#endif
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS
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
  const vec2 uv = gl_FragCoord.xy * frame.pixelSize;
  const vec3 ray = frame.rayOrigin + uv.x * frame.rayRight + uv.y * frame.rayDown;
  return frame.eye + frame.depthScale / (depth + frame.depthOffset) * ray;
}

#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_OUTSIDE || LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS
/// As in server/scene/emitter_list.h.
float farFromEmitters(vec3 p) {
  const vec3 dims = vec3(frame.dims);
  if (any(lessThan(p, vec3(0.5))) || any(greaterThan(p, dims - 0.5))) return 0.0;
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_OUTSIDE
  return 1.0;
#else
  return smoothstep(kNearFieldBegin, kNearFieldEnd, textureLod(emitterDistance, p / dims, 0.0).x);
#endif
}
#endif

vec3 irradiance(vec3 p, vec3 n) {
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EVERYWHERE
  return directIrradiance(p, n);
#else
  const vec3 e = irradianceAt(p, n, frame.dims, frame.palette);
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_OUTSIDE || LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS
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
  colour = vec4(displayFromRadiance(colour.rgb, frame.exposure.factor), 1.0);
#endif
}
