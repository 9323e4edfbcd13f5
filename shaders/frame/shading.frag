// Deferred shading: a pixel is the emission of a light in front, else albedo E / pi, else black. LPV_DISPLAY: exposed,
// through the tone curve, for 8 bits; else linear radiance, with 1 in alpha where a surface is seen. LPV_PANES: some of it
// is seen through panes. LPV_GLOSS: surfaces have lobes (frame/gloss.glsl). LPV_SUBPIXELS: several samples of each pixel say
// what is in it (frame/subpixels.glsl); LPV_APART: and have found what that sends (frame/apart_sum.comp). LPV_HAZE: some of it is lost in haze, which shines itself (frame/haze.comp).
#include "layout.h"
#include "common/sh.glsl"
#include "common/octahedral.glsl"
#include "common/tonemap.glsl"
#include "frame/position.glsl"

#ifndef LPV_DISPLAY
#error "LPV_DISPLAY: 0 or 1"
#endif
// LPV_IRRADIANCE: what surfaces receive instead, linear.
#if !defined LPV_IRRADIANCE || (LPV_IRRADIANCE && LPV_DISPLAY)
#error "LPV_IRRADIANCE: 0 or 1, which is not for displays"
#endif
#ifndef LPV_PANES
#error "LPV_PANES: 0 or 1"
#elif LPV_PANES
layout(binding = kPanes) uniform sampler2D panes;
#endif
#ifndef LPV_GLOSS
#error "LPV_GLOSS: 0 or 1"
#elif LPV_GLOSS
layout(binding = kGloss) uniform sampler2D gloss;
#endif
#ifndef LPV_HAZE
#error "LPV_HAZE: 0 or 1"
#elif LPV_HAZE
#include "visibility/haze.glsl"
layout(binding = kHaze) uniform sampler2D haze;
#endif
#ifndef LPV_SUBPIXELS
#error "LPV_SUBPIXELS: 0 or 1"
#elif LPV_SUBPIXELS
#include "frame/subpixels.glsl"
#endif
#if !defined LPV_APART || (LPV_APART && !LPV_SUBPIXELS)
#error "LPV_APART: 0 or 1, which are subpixels"
#elif LPV_SUBPIXELS && !LPV_APART
layout(binding = kSubpixelsOwn) uniform sampler2D ownSubpixels;
layout(binding = kSubpixelsFirst) uniform sampler2D firstSubpixels;
layout(binding = kSubpixelsSecond) uniform sampler2D secondSubpixels;
#endif
// LPV_NEAR_FIELD: where receivers evaluate the lights themselves.
#ifndef LPV_NEAR_FIELD
#error "LPV_NEAR_FIELD: LPV_NEAR_FIELD_NOWHERE, _EMITTERS, _EVERYWHERE, _SAMPLED or _KNOWN (shaders/layout.h)"
#endif
#if LPV_NEAR_FIELD != LPV_NEAR_FIELD_KNOWN
#include "transport/lookup.glsl"
#endif
// LPV_LOOKED_AT: beside what is looked up, shares of lights are looked at everywhere.
#ifndef LPV_LOOKED_AT
#error "LPV_LOOKED_AT: 0 or 1"
#endif
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS || LPV_NEAR_FIELD == LPV_NEAR_FIELD_EVERYWHERE || LPV_LOOKED_AT
#include "transport/emitter_list.glsl"
#endif
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS
#include "transport/emitter_distance.glsl"
#elif LPV_NEAR_FIELD == LPV_NEAR_FIELD_SAMPLED || LPV_NEAR_FIELD == LPV_NEAR_FIELD_KNOWN
layout(binding = kNearField) uniform sampler2D nearField;
#endif

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(binding = kAlbedo) uniform sampler2D albedo;
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmission) uniform sampler2D emission;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;

layout(location = 0) out vec4 colour;

#if LPV_NEAR_FIELD != LPV_NEAR_FIELD_KNOWN
vec3 farIrradiance(vec3 p, vec3 n) {
  const vec3 e = irradianceAt(p, n, frame.dims, frame.palette);
#if LPV_LOOKED_AT
  return e + lookedAtIrradiance(p, n);
#else
  return e;
#endif
}
#endif

#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EVERYWHERE
vec3 irradiance(ivec2 pixel, vec3 p, vec3 n) { return directIrradiance(p, n); }
#elif LPV_NEAR_FIELD == LPV_NEAR_FIELD_KNOWN
vec3 irradiance(ivec2 pixel, vec3 p, vec3 n) { return texelFetch(nearField, pixel, 0).rgb; }
#elif LPV_NEAR_FIELD == LPV_NEAR_FIELD_SAMPLED
vec3 irradiance(ivec2 pixel, vec3 p, vec3 n) {
  const vec4 near = texelFetch(nearField, pixel, 0);
  return near.w < 1.0 ? mix(farIrradiance(p, n), near.rgb, near.w) : near.rgb;
}
#else
vec3 irradiance(ivec2 pixel, vec3 p, vec3 n) {
  const vec3 e = farIrradiance(p, n);
#if LPV_NEAR_FIELD == LPV_NEAR_FIELD_EMITTERS
  const float far = farFromEmitters(p, frame.dims);
  if (far < 1.0) return mix(directIrradiance(p, n), e, far);
#endif
  return e;
}
#endif

/// By white.
vec3 reflected(ivec2 pixel) {
  const float depth = texelFetch(surfaceDepth, pixel, 0).x;
  const vec3 n = unitFromOctahedral(texelFetch(normal, pixel, 0).xy);
  return irradiance(pixel, gridPosition(frame, vec2(pixel) + 0.5, depth), n) / kPi;
}

/// By a surface of an albedo that is lit as the pixel is.
vec3 reflected(ivec2 pixel, vec3 albedo) {
#if LPV_GLOSS
  const vec4 lobe = texelFetch(gloss, pixel, 0);
  return lobe.rgb + lobe.a * albedo * reflected(pixel);
#else
  return albedo * reflected(pixel);
#endif
}

#if LPV_HAZE
/// What reaches the eye from what is in the middle of a pixel.
float throughHaze(ivec2 pixel, float depth) { return throughHaze(gridPosition(frame, vec2(pixel) + 0.5, depth), frame.eye); }
#endif

#if LPV_SUBPIXELS && !LPV_APART
/// What a share of a pixel shows that is lit as one of those around it, less what is in front of that one itself.
vec3 seen(ivec2 pixel, vec4 subpixels) {
  const int count = countOf(subpixels);
  if (count == 0) return vec3(0.0);
  const ivec2 at = pixel + pixelAround(codeOf(subpixels));
  const float share = float(count) / float(frame.samples);
#if LPV_HAZE
  const vec3 shines = texelFetch(haze, at, 0).rgb - texelFetch(haze, pixel, 0).rgb;
  return share * (throughHaze(at, texelFetch(surfaceDepth, at, 0).x) * reflected(at, subpixels.rgb) + shines);
#else
  return share * reflected(at, subpixels.rgb);
#endif
}

vec3 radiance(ivec2 pixel) {
  return texelFetch(emission, pixel, 0).rgb + seen(pixel, texelFetch(ownSubpixels, pixel, 0)) +
         seen(pixel, texelFetch(firstSubpixels, pixel, 0)) + seen(pixel, texelFetch(secondSubpixels, pixel, 0));
}
#endif

void main() {
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  const float surface = texelFetch(surfaceDepth, pixel, 0).x;
  const float emitter = texelFetch(emitterDepth, pixel, 0).x;  // reversed: larger is nearer, 0 is nothing
  const bool lightInFront = emitter > 0.0 && emitter >= surface;
  colour = vec4(vec3(0.0), surface > 0.0 && !lightInFront ? 1.0 : 0.0);
#if LPV_IRRADIANCE
  colour.rgb = colour.a * kPi * reflected(pixel);
#elif LPV_APART
  colour.rgb = texelFetch(emission, pixel, 0).rgb;  // and of surfaces
#elif LPV_SUBPIXELS
  colour.rgb = radiance(pixel);
#else
  if (lightInFront) {
    colour.rgb = texelFetch(emission, pixel, 0).rgb;
  } else if (surface > 0.0) {
    colour.rgb = reflected(pixel, texelFetch(albedo, pixel, 0).rgb);
  }
#endif
#if LPV_HAZE && !LPV_SUBPIXELS
  colour.rgb *= throughHaze(pixel, max(surface, emitter));
#endif
#if LPV_PANES && !LPV_IRRADIANCE
  colour.rgb *= texelFetch(panes, pixel, 0).rgb;
#endif
#if LPV_HAZE
  colour.rgb += texelFetch(haze, pixel, 0).rgb;
#endif
#if LPV_DISPLAY
  colour = vec4(displayFromRadiance(colour.rgb, frame.exposure.factor), 1.0);
#endif
}
