// What one sample of each pixel adds to the pixel's subpixels (frame/subpixels.glsl). The sample's surface is lit as the
// pixel in the middle of the nine around it is whose surface is most nearly the sample's own: light is found once per
// pixel, edges and textures as often as there are samples. A thread has a pixel. LPV_APART: the light of middles is known, and
// a sample unlike its own pixel's gets light of its own (frame/apart_list.comp). LPV_PANES: some are seen through panes;
// LPV_HAZE: through haze, surfaces as the pixel that they are lit as (frame/shading.frag).
#include "layout.h"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/subpixels.glsl"

#ifndef LPV_PANES
#error "LPV_PANES: 0 or 1"
#endif
#ifndef LPV_APART
#error "LPV_APART: 0 or 1"
#elif LPV_APART
#include "frame/sent.glsl"
#endif
#ifndef LPV_HAZE
#error "LPV_HAZE: 0 or 1"
#elif LPV_HAZE && !LPV_APART
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

layout(binding = kSubpixelRadianceOut, rgba32f) uniform image2D radiance;
#if LPV_APART
layout(binding = kNearField) uniform sampler2D nearField;
layout(binding = kApartAlbedoOut, rgba16f) uniform image2D albedoOut;
layout(binding = kApartPlaceOut, rgba32f) uniform image2D placeOut;
layout(binding = kApartNormalOut, rg16) uniform image2D placeNormalOut;
layout(binding = kSubpixelLightsOut, rgba32f) uniform image2D lights;

const float kSame = 0.1;         // up to here one surface is lit as another is
#else
layout(binding = kSubpixelOwnOut, rgba16f) uniform image2D ownOut;
layout(binding = kSubpixelFirstOut, rgba16f) uniform image2D firstOut;
layout(binding = kSubpixelSecondOut, rgba16f) uniform image2D secondOut;

const float kSame = 0.25;        // up to here the pixel's own surface is the sample's, whatever is around it
#endif
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

/// The surface in the middle of a pixel, whether light was found there.
bool surfaceAt(ivec2 at, out Surface there) {
  if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, textureSize(surfaceDepth, 0)))) return false;
  const float depth = texelFetch(surfaceDepth, at, 0).x, emitter = texelFetch(emitterDepth, at, 0).x;
  there = Surface(gridPosition(frame, vec2(at) + 0.5, depth), unitFromOctahedral(texelFetch(normal, at, 0).xy));
  return depth > 0.0 && (emitter <= 0.0 || emitter < depth);
}

/// The pixel that a sample is most like.
struct Like {
  int code;  // of those around; none: kNoPixel
  float unlike;
};

Like pixelLike(ivec2 pixel, Surface s, float footprint) {
  Like best = Like(kNoPixel, 1e30);
  for (int i = 0; i < kPixelsAround; ++i) {
    const ivec2 at = pixel + pixelAround(i);
    Surface there;
    if (!surfaceAt(at, there)) continue;
    const float unlike = unlikeness(there, s, footprint);
    if (unlike >= best.unlike) continue;
    best = Like(i, unlike);
    if (i == kOwnPixel && unlike < kSame) return best;
  }
  return best;
}

/// The mean of what is there and one more.
vec4 with(vec4 subpixels, vec3 albedo, int code) {
  const float count = float(countOf(subpixels)) + 1.0;
  return vec4(subpixels.rgb + (albedo - subpixels.rgb) / count, packedSubpixels(int(count), code));
}

/// Whether a pixel is summed up; those of rows beside are only looked at by it.
bool isWanted(ivec2 pixel) { return pixel.y >= params.firstWanted && pixel.y < params.endWanted; }

#if LPV_APART
/// Adds a sample that is most like the pixel of `code` to one of the places of the pixel at `at`, of the rows that are sampled.
void addApart(ivec2 at, Surface s, float depth, vec3 albedo, int code, float footprint) {
  const int width = imageSize(radiance).x, places = imageSize(albedoOut).x / width;
  ivec2 best = at;
  float least = 1e30;
  for (int i = 0; i < places && least > kSame; ++i) {
    const ivec2 place = placeApart(at, i, width);
    const vec4 there = imageLoad(albedoOut, place);
    if (countOf(there) == 0) {
      imageStore(albedoOut, place, vec4(albedo, packedSubpixels(1, code)));
      imageStore(placeOut, place, vec4(s.position, depth));
      imageStore(placeNormalOut, place, vec4(octahedralFromDirection(s.normal), 0.0, 0.0));
      return;
    }
    const Surface other = Surface(imageLoad(placeOut, place).xyz, unitFromOctahedral(imageLoad(placeNormalOut, place).xy));
    const float unlike = unlikeness(other, s, footprint);
    if (unlike >= least) continue;
    least = unlike;
    best = place;
  }
  const vec4 there = imageLoad(albedoOut, best);
  imageStore(albedoOut, best, with(there, albedo, codeOf(there)));
}
#else
/// Adds a sample to those that are lit as one of up to two pixels around.
void addBeside(ivec2 pixel, vec3 albedo, int like) {
  const vec4 one = imageLoad(firstOut, pixel);
  if (countOf(one) == 0 || codeOf(one) == like) {
    imageStore(firstOut, pixel, with(one, albedo, like));
  } else {
    const vec4 two = imageLoad(secondOut, pixel);
    imageStore(secondOut, pixel, with(two, albedo, countOf(two) == 0 ? like : codeOf(two)));
  }
}
#endif

void addRadiance(ivec2 pixel, vec3 shown) {
  imageStore(radiance, pixel, imageLoad(radiance, pixel) + vec4(shown / float(params.samples), 0.0));
}

void addLight(ivec2 at, ivec2 pixel, vec3 kept, float depth) {
#if LPV_HAZE
  kept *= throughHaze(gridPosition(frame, vec2(pixel) + 0.5 + params.offset, depth), frame.eye);
#endif
  const vec3 shown = kept * texelFetch(sampleEmission, at, 0).rgb;
#if LPV_APART
  imageStore(lights, pixel, imageLoad(lights, pixel) + vec4(shown, 1.0) / float(params.samplesOfLights));
  if (params.ofLights == 0) imageStore(radiance, pixel, imageLoad(radiance, pixel) + vec4(vec3(0.0), 1.0 / float(params.samples)));
#else
  addRadiance(pixel, shown);
#endif
}

void addSurface(ivec2 at, ivec2 pixel, vec3 kept, float depth) {
  const vec3 place = gridPosition(frame, vec2(pixel) + 0.5 + params.offset, depth);
  const Surface s = Surface(place, unitFromOctahedral(texelFetch(sampleNormal, at, 0).xy));
  const float footprint = frame.depthScale / (depth + frame.depthOffset) * length(frame.rayDown) * frame.pixelSize.y;
  const vec3 albedo = kept * texelFetch(sampleAlbedo, at, 0).rgb;
  const Like like = pixelLike(pixel, s, footprint);
#if LPV_APART
  if (like.code != kOwnPixel || like.unlike > kSame) {
    addApart(at, s, depth, albedo, like.code, footprint);
  } else if (isWanted(pixel)) {
    addRadiance(pixel, sent(frame, pixel, kOwnPixel, place, albedo, texelFetch(nearField, pixel, 0).rgb));
  }
#else
  if (like.code == kOwnPixel) {
    imageStore(ownOut, pixel, with(imageLoad(ownOut, pixel), albedo, kOwnPixel));
  } else if (like.code != kNoPixel) {
    addBeside(pixel, albedo, like.code);
  }
#endif
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + params.begin, pixel = at + ivec2(0, params.firstRow);
  if (any(greaterThanEqual(at, textureSize(sampleDepth, 0))) || any(greaterThanEqual(pixel, imageSize(radiance)))) return;
#if LPV_PANES
  const vec3 kept = texelFetch(samplePanes, at, 0).rgb;
#else
  const vec3 kept = vec3(1.0);
#endif
  const float depth = texelFetch(sampleDepth, at, 0).x, emitter = texelFetch(sampleEmitterDepth, at, 0).x;
  if (emitter > 0.0 && emitter >= depth) {
    if (isWanted(pixel)) addLight(at, pixel, kept, emitter);
  } else if (depth > 0.0 && params.ofLights == 0) {
    addSurface(at, pixel, kept, depth);
  }
}
