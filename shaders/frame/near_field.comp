// The near field of a picture, from fewer points than it has pixels: E by the lights themselves at every
// kNearFieldSpacing-th pixel of every kNearFieldSpacing-th row, then halfway between known points, along rows, along
// columns, until every pixel is known. Halfway between two points E is interpolated where depth and normal lie between
// theirs, and where the next two points on the line say that E bends little; else the lights are evaluated there. So
// edges, small objects and what is close to a light get E of their own.
//
// LPV_PASS: weights, and which tiles have a near field at all; the first points; those between, params.stride from what
// is known; or, of what surfaces reflect to a single frame, those that do not lie between points of a lattice
// (frame/lattice.glsl). LPV_EVERYWHERE: the lights themselves are looked at wherever a surface is seen. LPV_POOL: the picture is that of
// one pool of lights, also of what lights in front hide, and points that only rays can know are taken from fewer: halfway
// between the last known ones the mean will do, or what is beside on the same plane. A thread has a tile, or a block of
// points, and lists those to be evaluated (near_field_evaluate.comp).
#include "layout.h"
#include "frame/position.glsl"
#include "frame/point_list.glsl"

#if !defined LPV_PASS || LPV_PASS < LPV_PASS_WEIGHTS || LPV_PASS > LPV_PASS_LATTICE
#error "LPV_PASS: LPV_PASS_WEIGHTS, _FIRST, _BETWEEN or _LATTICE (shaders/layout.h)"
#endif
#ifndef LPV_EVERYWHERE
#error "LPV_EVERYWHERE: 0 or 1"
#endif
#if !defined LPV_POOL || (LPV_POOL && !LPV_EVERYWHERE)
#error "LPV_POOL: 0 or 1, which looks everywhere"
#endif
#if LPV_PASS == LPV_PASS_WEIGHTS && !LPV_EVERYWHERE
#include "transport/emitter_distance.glsl"
#endif

layout(local_size_x = kNearFieldGroup) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;
/// rgb: E in W/m^2; a: its weight beside the volume's, 0 where E is not known.
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;
layout(std430, binding = kNearFieldTiles) buffer Tiles { uint tiles[]; };
#include "frame/plane.glsl"
#include "frame/lattice.glsl"

#if LPV_POOL
const float kTolerance = 0.08;
const float kSteepness[3] = float[3](0.25, 0.4, 1e9);
const float kLongestSpan = 1.5;
const int kFinest = 2;                // pixels from known points up to which nothing is evaluated for how E bends
#else
const float kTolerance = 0.03;        // by how much E may bend, as a share of it
// By how much E may differ halfway, as a share of it, where two, three or four points know it: kinks show by four only.
const float kSteepness[3] = float[3](0.12, 0.25, 1e9);
const float kLongestSpan = 0.5;       // cells from point to point: E may have peaks as narrow
const int kFinest = 0;
#endif
const float kLeastWeight = 0.02;      // below, the volume alone is near enough
const float kDepthTolerance = 0.15;   // off the line between two points, as a share of their distance
const float kNormalTolerance = 0.06;  // off the mean of their normals
const float kLeastCosine = 0.7;       // between these

ivec2 pictureSize() { return textureSize(surfaceDepth, 0); }

ivec2 tilesOfPicture() { return (pictureSize() + kNearFieldTile - 1) / kNearFieldTile; }

vec3 positionAt(ivec2 pixel, float depth) { return gridPosition(frame, vec2(pixel) + 0.5, depth); }

#if LPV_PASS == LPV_PASS_WEIGHTS
/// Of E by the lights themselves; 0 where no surface is seen.
float weightAt(ivec2 pixel) {
  const float depth = texelFetch(surfaceDepth, pixel, 0).x;
#if LPV_POOL
  const float emitter = 0.0;
#else
  const float emitter = texelFetch(emitterDepth, pixel, 0).x;
#endif
  if (depth <= 0.0 || (emitter > 0.0 && emitter >= depth)) return 0.0;
#if LPV_EVERYWHERE
  return 1.0;
#else
  return 1.0 - farFromEmitters(positionAt(pixel, depth), frame.dims);
#endif
}

void main() {
  const ivec2 tiles2 = tilesOfPicture(), size = pictureSize();
  const int index = params.first + int(gl_GlobalInvocationID.x);
  if (index >= tiles2.x * tiles2.y) return;
  const ivec2 corner = kNearFieldTile * ivec2(index % tiles2.x, index / tiles2.x);
  const ivec2 end = min(corner + kNearFieldTile, size);
  bool near = false;
  for (int y = corner.y; y < end.y; ++y) {
    for (int x = corner.x; x < end.x; ++x) {
      const float weight = weightAt(ivec2(x, y));
      imageStore(nearField, ivec2(x, y), vec4(0.0, 0.0, 0.0, weight));
      near = near || weight > 0.0;
    }
  }
  tiles[index] = near ? 1u : 0u;
}
#else

#if LPV_PASS == LPV_PASS_LATTICE
ivec2 pointSpacing() { return ivec2(1); }
bool toEvaluate(ivec2 pixel) { return imageLoad(nearField, pixel).w > 0.0 && !liesBetween(pixel); }
#elif LPV_PASS == LPV_PASS_FIRST
/// From a point of this pass to the next one.
ivec2 pointSpacing() { return ivec2(params.spacing); }
bool toEvaluate(ivec2 pixel) { return imageLoad(nearField, pixel).w > 0.0; }
#else
ivec2 pointSpacing() {
  const int s = params.stride.x + params.stride.y;
  return params.stride.x > 0 ? ivec2(2 * s) : ivec2(s, 2 * s);
}

float largest(vec3 v) { return max(max(v.r, v.g), v.b); }

/// Stored depth is linear on a plane: is the pixel on the line from before to after, and are these close together?
bool onOneSurface(ivec2 pixel, ivec2 before, ivec2 after) {
  const float depth = texelFetch(surfaceDepth, pixel, 0).x;
  const float depthBefore = texelFetch(surfaceDepth, before, 0).x, depthAfter = texelFetch(surfaceDepth, after, 0).x;
  const vec3 off = positionAt(pixel, 0.5 * (depthBefore + depthAfter)) - positionAt(pixel, depth);
  const vec3 apart = positionAt(after, depthAfter) - positionAt(before, depthBefore);
  const float span = dot(apart, apart);
  if (span > kLongestSpan * kLongestSpan || dot(off, off) > kDepthTolerance * kDepthTolerance * span) return false;
  const vec3 n = normalAt(pixel), nBefore = normalAt(before), nAfter = normalAt(after);
  return dot(nBefore, nAfter) >= kLeastCosine && length(n - 0.5 * (nBefore + nAfter)) <= kNormalTolerance;
}

/// E halfway between the points before and after, by a cubic through these and the next on both sides; false where it
/// cannot be trusted.
bool interpolated(ivec2 pixel, float weight, out vec3 e) {
  const ivec2 stride = params.stride, before = pixel - stride, after = pixel + stride;
  e = vec3(0.0);
  if (any(greaterThanEqual(after, pictureSize()))) return false;
  const vec4 e1 = imageLoad(nearField, before), e2 = imageLoad(nearField, after);
  if (e1.w == 0.0 || e2.w == 0.0 || !onOneSurface(pixel, before, after)) return false;
  const vec4 e0 = imageLoad(nearField, before - 2 * stride), e3 = imageLoad(nearField, after + 2 * stride);
  const int outer = (e0.w > 0.0 ? 1 : 0) + (e3.w > 0.0 ? 1 : 0);
  const vec3 line = 0.5 * (e1.rgb + e2.rgb), steep = e2.rgb - e1.rgb;
  const vec3 first = e0.w > 0.0 ? e0.rgb : e1.rgb - 3.0 * steep + (e3.w > 0.0 ? e3.rgb - e1.rgb : 2.0 * steep);
  const vec3 last = e3.w > 0.0 ? e3.rgb : e2.rgb + 3.0 * steep + (e0.w > 0.0 ? e0.rgb - e2.rgb : -2.0 * steep);
  const vec3 bend = 0.0625 * (e1.rgb + e2.rgb - first - last);
  e = max(line + bend, vec3(0.0));
  if (stride.x + stride.y <= kFinest) {
    e = line;
    return true;
  }
  return weight * largest(abs(bend)) <= kTolerance * largest(line) &&
         weight * largest(abs(steep)) <= kSteepness[outer] * largest(line);
}

#if LPV_POOL
/// Whether a known point is on the pixel's plane, and near it.
bool isBeside(ivec2 pixel, ivec2 known) {
  if (any(greaterThanEqual(known, pictureSize())) || imageLoad(nearField, known).w == 0.0) return false;
  const vec3 n = normalAt(pixel);
  const vec3 d = positionAt(known, texelFetch(surfaceDepth, known, 0).x) - positionAt(pixel, texelFetch(surfaceDepth, pixel, 0).x);
  return dot(n, normalAt(known)) >= kLeastCosine && abs(dot(n, d)) <= kDepthTolerance * length(d) + 1e-4 &&
         dot(d, d) <= kLongestSpan * kLongestSpan;
}

/// E of the point beside, of one of the two.
bool copied(ivec2 pixel, out vec3 e) {
  e = vec3(0.0);
  if (params.stride.x + params.stride.y > kFinest) return false;
  const ivec2 before = pixel - params.stride, after = pixel + params.stride;
  const bool isBefore = isBeside(pixel, before);
  if (!isBefore && !isBeside(pixel, after)) return false;
  e = imageLoad(nearField, isBefore ? before : after).rgb;
  return true;
}
#endif

bool toEvaluate(ivec2 pixel) {
  const float weight = imageLoad(nearField, pixel).w;
  if (weight == 0.0) return false;
  vec3 e;
  bool known = interpolated(pixel, weight, e);
#if LPV_POOL
  known = known || copied(pixel, e);
#endif
  if (!known && weight >= kLeastWeight) return true;
  imageStore(nearField, pixel, vec4(e, known ? weight : 0.0));
  return false;
}
#endif

/// Has a part of the picture a near field at all?
bool nearIn(ivec2 corner, ivec2 extent) {
  const ivec2 tiles2 = tilesOfPicture(), first = corner / kNearFieldTile;
  const ivec2 last = min((corner + extent - 1) / kNearFieldTile, tiles2 - 1);
  uint near = 0u;
  for (int y = first.y; y <= last.y; ++y) {
    for (int x = first.x; x <= last.x; ++x) near |= tiles[y * tiles2.x + x];
  }
  return near != 0u;
}

void main() {
  const ivec2 size = pictureSize(), spacing = pointSpacing();
  const ivec2 block = spacing * ivec2(kNearFieldBlockX, kNearFieldBlockY), blocks = (size + block - 1) / block;
  const int index = params.first + int(gl_GlobalInvocationID.x);
  if (index >= blocks.x * blocks.y) return;
  const ivec2 begin = block * ivec2(index % blocks.x, index / blocks.x), corner = begin + params.stride;
  const int count = nearIn(begin, block) ? kNearFieldBlockX * kNearFieldBlockY : 0;
  uint bits = 0u;
  for (int i = 0; i < count; ++i) {
    const ivec2 pixel = corner + spacing * ivec2(i % kNearFieldBlockX, i / kNearFieldBlockX);
    if (all(lessThan(pixel, size)) && toEvaluate(pixel)) bits |= 1u << i;
  }
  listPoints(bits, corner, spacing);
}
#endif
