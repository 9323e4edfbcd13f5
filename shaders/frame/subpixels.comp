// What one sample of each pixel adds to the pixel's subpixels (frame/subpixels.glsl). The sample's surface is lit as the
// pixel in the middle of the nine around it is whose surface is most nearly the sample's own: light is found once per
// pixel, edges and textures as often as there are samples. A thread has a pixel. LPV_PANES: some are seen through panes; LPV_HAZE:
// lights through haze, surfaces as the pixel that they are lit as (frame/shading.frag). LPV_APART: where none of the nine is like
// a sample, what is thinner than a pixel, light is found at the sample's own place (frame/apart_list.comp).
#include "layout.h"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/subpixels.glsl"

#ifndef LPV_PANES
#error "LPV_PANES: 0 or 1"
#endif
#ifndef LPV_APART
#error "LPV_APART: 0 or 1"
#endif
#ifndef LPV_HAZE
#error "LPV_HAZE: 0 or 1"
#elif LPV_HAZE
#include "visibility/haze.glsl"
#endif

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kSubpixelParams) uniform SubpixelBlock { SubpixelParams params; };

// Of the middle of each pixel.
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;

// Of the sample; the first row is params.firstRow.
layout(binding = kSampleAlbedo) uniform sampler2D sampleAlbedo;
layout(binding = kSampleNormal) uniform sampler2D sampleNormal;
layout(binding = kSampleDepth) uniform sampler2D sampleDepth;
layout(binding = kSampleEmission) uniform sampler2D sampleEmission;
layout(binding = kSampleEmitterDepth) uniform sampler2D sampleEmitterDepth;
#if LPV_PANES
layout(binding = kPanes) uniform sampler2D samplePanes;
#endif

layout(binding = kSubpixelEmissionOut, rgba32f) uniform image2D emissionOut;
layout(binding = kSubpixelOwnOut, rgba16f) uniform image2D ownOut;
layout(binding = kSubpixelFirstOut, rgba16f) uniform image2D firstOut;
layout(binding = kSubpixelSecondOut, rgba16f) uniform image2D secondOut;
#if LPV_APART
layout(binding = kSubpixelApartOut, rgba16f) uniform image2D apartOut;
layout(binding = kApartPlaceOut, rgba32f) writeonly uniform image2D placeOut;
layout(binding = kApartNormalOut, rg16) writeonly uniform image2D placeNormalOut;

const float kApart = 0.35;        // beyond, a pixel's light is not the sample's
#endif

const float kSame = 0.25;        // up to here the pixel's own surface is the sample's, whatever is around it
const float kNormalWeight = 4.0; // of 1 - cosine, beside pixels off the plane

struct Surface {
  vec3 position;  // grid space
  vec3 normal;
};

/// How unlike two surfaces are: by their planes, in pixels, and by their normals.
float unlikeness(Surface a, Surface b, float pixel) {
  const vec3 apart = b.position - a.position;
  const float offPlane = max(abs(dot(apart, a.normal)), abs(dot(apart, b.normal)));
  return offPlane / pixel + kNormalWeight * (1.0 - dot(a.normal, b.normal));
}

/// The code of the pixel, of those around `pixel` where light was found, that is most like `s`, and how unlike it is;
/// none: kNoPixel.
int pixelLike(ivec2 pixel, Surface s, float footprint, out float least) {
  int best = kNoPixel;
  least = 1e30;
  for (int i = 0; i < kPixelsAround; ++i) {
    const ivec2 at = pixel + pixelAround(i);
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, textureSize(surfaceDepth, 0)))) continue;
    const float depth = texelFetch(surfaceDepth, at, 0).x, emitter = texelFetch(emitterDepth, at, 0).x;
    if (depth <= 0.0 || (emitter > 0.0 && emitter >= depth)) continue;
    const Surface there = Surface(gridPosition(frame, vec2(at) + 0.5, depth),
                                  unitFromOctahedral(texelFetch(normal, at, 0).xy));
    const float unlike = unlikeness(there, s, footprint);
    if (unlike >= least) continue;
    least = unlike;
    best = i;
    if (i == kOwnPixel && unlike < kSame) return i;
  }
  return best;
}

/// The mean of what is there and one more.
vec4 with(vec4 subpixels, vec3 albedo, int code) {
  const float count = float(countOf(subpixels)) + 1.0;
  return vec4(subpixels.rgb + (albedo - subpixels.rgb) / count, packedSubpixels(int(count), code));
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy), pixel = at + ivec2(0, params.firstRow);
  if (any(greaterThanEqual(at, textureSize(sampleDepth, 0))) || any(greaterThanEqual(pixel, imageSize(ownOut)))) return;
  const bool first = params.sampleIndex == 0;
  vec4 emission = first ? vec4(0.0) : imageLoad(emissionOut, pixel);
  vec4 own = first ? vec4(0.0) : imageLoad(ownOut, pixel);
  vec4 one = first ? vec4(0.0) : imageLoad(firstOut, pixel);
  vec4 two = first ? vec4(0.0) : imageLoad(secondOut, pixel);
#if LPV_APART
  vec4 apart = first ? vec4(0.0) : imageLoad(apartOut, pixel);
#endif

#if LPV_PANES
  const vec3 kept = texelFetch(samplePanes, at, 0).rgb;
#else
  const vec3 kept = vec3(1.0);
#endif
  const float depth = texelFetch(sampleDepth, at, 0).x, emitter = texelFetch(sampleEmitterDepth, at, 0).x;
  if (emitter > 0.0 && emitter >= depth) {
#if LPV_HAZE
    const float arrives = throughHaze(gridPosition(frame, vec2(pixel) + 0.5 + params.offset, emitter), frame.eye);
#else
    const float arrives = 1.0;
#endif
    emission.rgb += arrives * kept * texelFetch(sampleEmission, at, 0).rgb / float(params.samples);
  } else if (depth > 0.0) {
    const vec2 where = vec2(pixel) + 0.5 + params.offset;
    const Surface s = Surface(gridPosition(frame, where, depth), unitFromOctahedral(texelFetch(sampleNormal, at, 0).xy));
    const float viewDepth = frame.depthScale / (depth + frame.depthOffset);
    float unlike;
    const int like = pixelLike(pixel, s, viewDepth * length(frame.rayDown) * frame.pixelSize.y, unlike);
    const vec3 albedo = kept * texelFetch(sampleAlbedo, at, 0).rgb;
#if LPV_APART
    if (unlike > kApart) {
      if (countOf(apart) == 0) {
        imageStore(placeOut, pixel, vec4(rayStart(frame, s.position, s.normal, depth), 1.0));
        imageStore(placeNormalOut, pixel, texelFetch(sampleNormal, at, 0));
      }
      apart = with(apart, albedo, kOwnPixel);
    } else
#endif
    if (like == kOwnPixel) {
      own = with(own, albedo, like);
    } else if (like != kNoPixel) {
      if (countOf(one) == 0 || codeOf(one) == like) {
        one = with(one, albedo, like);
      } else {
        two = with(two, albedo, countOf(two) == 0 ? like : codeOf(two));
      }
    }
  }
  imageStore(emissionOut, pixel, emission);
  imageStore(ownOut, pixel, own);
  imageStore(firstOut, pixel, one);
  imageStore(secondOut, pixel, two);
#if LPV_APART
  imageStore(apartOut, pixel, apart);
#endif
}
