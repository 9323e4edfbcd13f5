// The near field of a picture, from fewer points than it has pixels: E by the lights themselves at every
// kNearFieldSpacing-th pixel of every kNearFieldSpacing-th row, then halfway between known points, along rows, along
// columns, until every pixel is known. Halfway between two points E is interpolated where depth and normal are, too,
// and where two more points on the line say that E bends little; else the lights are evaluated there.
// So edges, small objects and what is close to a light get E of their own.
//
// LPV_FIRST 1: the first points, and which tiles have a near field at all. 0: the points between, params.stride from
// those before and after.
#include "layout.h"
#include "common/sh.glsl"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "transport/emitter_distance.glsl"
#include "transport/emitter_list_four.glsl"

#ifndef LPV_FIRST
#error "LPV_FIRST: 0 or 1"
#endif

layout(local_size_x = kNearFieldGroup) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;
/// rgb: E in W/m^2; a: its weight beside the volume's, 0 where E is not known.
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;
layout(std430, binding = kNearFieldTiles) buffer Tiles { uint tiles[]; };

const int kMaxPoints = 4 * kNearFieldGroup;  // of a tile in one dispatch; four to a thread
const int kWords = kMaxPoints / 32;
const float kTolerance = 0.01;        // by how much E may bend, as a share of it
const float kUnbent = 4.0;            // with two points: of kTolerance, by how much they may differ
const float kLeastWeight = 0.02;      // below, the volume alone is near enough
const float kDepthTolerance = 0.1;    // off the line between two points, as a share of their distance
const float kNormalTolerance = 0.03;  // off the mean of their normals
const float kLeastCosine = 0.7;       // between these

shared uint evaluated[kWords];  // a bit per point of the tile

ivec2 tileCorner() {
  return ivec2(gl_WorkGroupID.x, params.firstRow + int(gl_WorkGroupID.y)) * ivec2(kNearFieldTileX, kNearFieldTileY);
}

ivec2 pictureSize() { return textureSize(surfaceDepth, 0); }

vec3 positionAt(ivec2 pixel, float depth) { return gridPosition(frame, vec2(pixel) + 0.5, depth); }

vec3 normalAt(ivec2 pixel) { return unitFromOctahedral(texelFetch(normal, pixel, 0).xy); }

/// Of E by the lights themselves; 0 where no surface is seen.
float weightAt(ivec2 pixel) {
  const float depth = texelFetch(surfaceDepth, pixel, 0).x, emitter = texelFetch(emitterDepth, pixel, 0).x;
  if (depth <= 0.0 || (emitter > 0.0 && emitter >= depth)) return 0.0;
  return 1.0 - farFromEmitters(positionAt(pixel, depth), frame.dims);
}

#if LPV_FIRST
const int kPointsX = kNearFieldTileX / kNearFieldSpacing, kPoints = kPointsX * kNearFieldTileY / kNearFieldSpacing;

int pointsOfTile() { return kPoints; }

ivec2 pixelOf(int point) {
  return tileCorner() + kNearFieldSpacing * ivec2(point % kPointsX, point / kPointsX);
}

bool toEvaluate(ivec2 pixel) { return weightAt(pixel) > 0.0; }

/// Weights of all of the tile's pixels; says that there are any.
void weigh() {
  const ivec2 size = pictureSize();
  for (int i = int(gl_LocalInvocationIndex); i < kNearFieldTileX * kNearFieldTileY; i += kNearFieldGroup) {
    const ivec2 pixel = tileCorner() + ivec2(i % kNearFieldTileX, i / kNearFieldTileX);
    if (any(greaterThanEqual(pixel, size))) continue;
    const float weight = weightAt(pixel);
    const bool evaluatedBelow = weight > 0.0 && pixel % kNearFieldSpacing == ivec2(0);
    if (!evaluatedBelow) imageStore(nearField, pixel, vec4(0.0, 0.0, 0.0, weight));
    if (weight > 0.0) tiles[(params.firstRow + gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x] = 1u;
  }
}
#else
/// From a point to the next one of this pass.
ivec2 pointSpacing() {
  const int s = params.stride.x + params.stride.y;
  return params.stride.x > 0 ? ivec2(2 * s) : ivec2(s, 2 * s);
}

int pointsOfTile() {
  const ivec2 spacing = pointSpacing();
  return (kNearFieldTileX / spacing.x) * (kNearFieldTileY / spacing.y);
}

ivec2 pixelOf(int point) {
  const ivec2 spacing = pointSpacing();
  const int across = kNearFieldTileX / spacing.x;
  return tileCorner() + params.stride + spacing * ivec2(point % across, point / across);
}

float largest(vec3 v) { return max(max(v.r, v.g), v.b); }

/// Stored depth is as good as linear on a plane: what of the pixel is off the line from before to after it?
bool onOneSurface(ivec2 pixel, ivec2 before, ivec2 after) {
  const float depth = texelFetch(surfaceDepth, pixel, 0).x;
  const float depthBefore = texelFetch(surfaceDepth, before, 0).x, depthAfter = texelFetch(surfaceDepth, after, 0).x;
  const vec3 off = positionAt(pixel, 0.5 * (depthBefore + depthAfter)) - positionAt(pixel, depth);
  const vec3 apart = positionAt(after, depthAfter) - positionAt(before, depthBefore);
  if (dot(off, off) > kDepthTolerance * kDepthTolerance * dot(apart, apart)) return false;
  const vec3 n = normalAt(pixel), nBefore = normalAt(before), nAfter = normalAt(after);
  return dot(nBefore, nAfter) >= kLeastCosine && length(n - 0.5 * (nBefore + nAfter)) <= kNormalTolerance;
}

/// E halfway between the points before and after, by a cubic through these and the next on both sides; nothing where
/// it cannot be trusted.
bool interpolated(ivec2 pixel, float weight, out vec3 e) {
  const ivec2 stride = params.stride, before = pixel - stride, after = pixel + stride;
  e = vec3(0.0);
  if (any(greaterThanEqual(after, pictureSize()))) return false;
  const vec4 e1 = imageLoad(nearField, before), e2 = imageLoad(nearField, after);
  if (e1.w == 0.0 || e2.w == 0.0 || !onOneSurface(pixel, before, after)) return false;
  const vec4 e0 = imageLoad(nearField, before - 2 * stride), e3 = imageLoad(nearField, after + 2 * stride);
  const vec3 line = 0.5 * (e1.rgb + e2.rgb);
  const float allowed = kTolerance * largest(line);
  if (e0.w == 0.0 && e3.w == 0.0) {
    e = line;
    return weight * largest(abs(e1.rgb - e2.rgb)) <= kUnbent * allowed;
  }
  const vec3 first = e0.w > 0.0 ? e0.rgb : 3.0 * (e1.rgb - e2.rgb) + e3.rgb;
  const vec3 last = e3.w > 0.0 ? e3.rgb : 3.0 * (e2.rgb - e1.rgb) + e0.rgb;
  const vec3 bend = 0.0625 * (e1.rgb + e2.rgb - first - last);
  e = max(line + bend, vec3(0.0));
  return weight * largest(abs(bend)) <= allowed;
}

bool toEvaluate(ivec2 pixel) {
  const float weight = imageLoad(nearField, pixel).w;
  if (weight == 0.0) return false;
  vec3 e;
  const bool known = interpolated(pixel, weight, e);
  if (!known && weight >= kLeastWeight) return true;
  imageStore(nearField, pixel, vec4(e, known ? weight : 0.0));
  return false;
}
#endif

void chooseEvaluated() {
  const ivec2 size = pictureSize();
  const int points = pointsOfTile();
  for (int i = int(gl_LocalInvocationIndex); i < points; i += kNearFieldGroup) {
    const ivec2 pixel = pixelOf(i);
    if (all(lessThan(pixel, size)) && toEvaluate(pixel)) atomicOr(evaluated[i >> 5], 1u << (i & 31));
  }
}

/// The k-th of the points that are evaluated, k below their number.
int evaluatedPoint(int k) {
  int word = 0;
  for (; word < kWords - 1; ++word) {
    const int here = bitCount(evaluated[word]);
    if (k < here) break;
    k -= here;
  }
  uint bits = evaluated[word];
  for (; k > 0; --k) bits &= bits - 1u;
  return 32 * word + findLSB(bits);
}

/// Points [first, last) of those, four at most.
void evaluate(int first, int last) {
  ivec2 pixels[4];
  FourReceivers r;
  for (int i = 0; i < 4; ++i) {
    pixels[i] = pixelOf(evaluatedPoint(min(first + i, last - 1)));
    const vec3 x = positionAt(pixels[i], texelFetch(surfaceDepth, pixels[i], 0).x), n = normalAt(pixels[i]);
    r.x[i] = x.x;
    r.y[i] = x.y;
    r.z[i] = x.z;
    r.nx[i] = n.x;
    r.ny[i] = n.y;
    r.nz[i] = n.z;
  }
  const FourIrradiances e = directIrradiances(r);
  for (int i = 0; i < min(4, last - first); ++i)
    imageStore(nearField, pixels[i], vec4(e.red[i], e.green[i], e.blue[i], weightAt(pixels[i])));
}

void main() {
#if !LPV_FIRST
  if (tiles[(params.firstRow + gl_WorkGroupID.y) * gl_NumWorkGroups.x + gl_WorkGroupID.x] == 0u) return;
#endif
  if (gl_LocalInvocationIndex < kWords) evaluated[gl_LocalInvocationIndex] = 0u;
  barrier();
#if LPV_FIRST
  weigh();
#endif
  chooseEvaluated();
  barrier();
  int count = 0;
  for (int i = 0; i < kWords; ++i) count += bitCount(evaluated[i]);
  const int first = 4 * int(gl_LocalInvocationIndex);
  if (first < count) evaluate(first, count);
}
