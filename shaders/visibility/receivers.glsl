// Receivers that light is summed at: pixels of a picture, or, with LPV_PATCHES, patches of the surfaces, whose number
// stands for the pixel's column; or, with LPV_MET, the places that the pixels' reflections have met; or, with LPV_APART, places
// of samples that are lit as no pixel's middle (frame/subpixels.comp), of which each pixel
// has several, in pictures side by side. Rays begin at rayStart().
#include "frame/position.glsl"
#ifndef LPV_PATCHES
#error "LPV_PATCHES: 0 or 1"
#endif
#if !defined LPV_MET || (LPV_MET && LPV_PATCHES)
#error "LPV_MET: 0 or 1, which are no patches"
#endif
#if !defined LPV_APART || (LPV_APART && (LPV_PATCHES || LPV_MET))
#error "LPV_APART: 0 or 1, which are neither"
#endif

layout(std430, binding = kNearFieldPoints) readonly buffer Points {
  ListHeader list;  // threads with four points each
  uvec4 points[];   // packedPixel(), or numbers of patches and pieces, of which there may be more than columns of a picture
};

#if LPV_PATCHES
#include "visibility/patches.glsl"

ivec2 receiverOf(uint listed) { return ivec2(listed, 0); }
vec3 receiverNormal(ivec2 pixel) { return patches[pixel.x].normal.xyz; }
vec3 receiverPosition(ivec2 pixel) { return patches[pixel.x].place.xyz; }
vec3 rayStart(ivec2 pixel, vec3 n) { return receiverPosition(pixel) + kShadowOffset * n; }

bool isTriangle(ivec2 pixel) { return patches[pixel.x].corners[0].w != 0.0; }

/// Of a turn's rays: from another place of a patch each turn (Roberts 2018), since some of it may be in the dark.
vec3 rayStart(ivec2 pixel, vec3 n, int turn) {
  if (!isTriangle(pixel)) return rayStart(pixel, n);
  const vec2 shift = float(pixel.x & 1023) * vec2(0.5698402910, 0.6180339887);
  return ownPlace(patches[pixel.x], fract(shift + float(turn) * vec2(0.7548776662, 0.5698402910))) + kShadowOffset * n;
}
#else
#include "common/octahedral.glsl"

bool isTriangle(ivec2 pixel) { return false; }

ivec2 receiverOf(uint listed) { return unpackedPixel(listed); }

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
#if LPV_MET
#include "frame/gloss_points.glsl"

vec3 receiverNormal(ivec2 pixel) { return glossPoints[glossIndex(frame, pixel)].normal.xyz; }
vec3 receiverPosition(ivec2 pixel) { return glossPoints[glossIndex(frame, pixel)].place.xyz; }
vec3 rayStart(ivec2 pixel, vec3 n) { return receiverPosition(pixel) + kShadowOffset * n; }
#elif LPV_APART
layout(binding = kApartPlace) uniform sampler2D apartPlace;
layout(binding = kApartNormal) uniform sampler2D apartNormal;

vec3 receiverNormal(ivec2 pixel) { return unitFromOctahedral(texelFetch(apartNormal, pixel, 0).xy); }
vec3 receiverPosition(ivec2 pixel) { return texelFetch(apartPlace, pixel, 0).xyz; }
vec3 rayStart(ivec2 pixel, vec3 n) {
  const vec4 place = texelFetch(apartPlace, pixel, 0);
  return rayStart(frame, place.xyz, n, place.a);
}
#else
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;

vec3 receiverNormal(ivec2 pixel) { return unitFromOctahedral(texelFetch(normal, pixel, 0).xy); }
vec3 receiverPosition(ivec2 pixel) {
  return gridPosition(frame, vec2(pixel) + 0.5, texelFetch(surfaceDepth, pixel, 0).x);
}
vec3 rayStart(ivec2 pixel, vec3 n) {
  return rayStart(frame, receiverPosition(pixel), n, texelFetch(surfaceDepth, pixel, 0).x);
}
#endif
#endif
