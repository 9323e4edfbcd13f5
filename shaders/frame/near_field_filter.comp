// Adds what a pool of lights, or what surfaces reflect, sends to the pixels of a picture: what would come with nothing in
// the way, times the share that arrives. A pixel's own rays are few, and neighbours send theirs elsewhere
// (shadow_rays.comp), so the share is the mean over pixels around that are on the same plane and whose shares do not differ
// by more than chance: edges of shadows stay where they are, the grain of penumbrae goes. A thread has a pixel.
// LPV_REFLECTED: light of all surfaces has no such edges, and fewer rays: all shares on the plane count that nothing parts
// from the pixel in the picture. Above a shelf, a wall sees other surfaces than below.
#include "layout.h"

#ifndef LPV_REFLECTED
#error "LPV_REFLECTED: 0 or 1"
#endif

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
#include "frame/plane_shares.glsl"
layout(binding = kPoolLight) uniform sampler2D poolLight;
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp
#include "frame/lattice.glsl"

const int kReach = 3;                // pixels on each side, or points of the lattice

float mean(vec3 v) { return dot(v, vec3(1.0 / 3.0)); }

#if !LPV_REFLECTED
/// Of a share, by chance. Rays are spread over the light, so it is below the binomial one; and few are never quite sure.
float variance(vec4 share) {
  const float p = mean(share.rgb);
  return 0.5 * (p * (1.0 - p) + 0.25 / share.w) / share.w;
}

/// Of the mean of two shares beside the pixel's own.
float weightOf(vec4 a, vec4 b, vec4 own) {
  const float bent = mean(0.5 * (a.rgb + b.rgb) - own.rgb);
  return exp(-0.5 * bent * bent / (variance(own) + 0.25 * (variance(a) + variance(b))));
}
#endif

/// Pixels around one by a bit each, row by row.
struct Around {
  uvec2 bits;
};

uint bitOf(ivec2 off) { return uint((off.y + kReach) * (2 * kReach + 1) + off.x + kReach); }
bool holds(Around set, ivec2 off) { return ((bitOf(off) < 32u ? set.bits.x : set.bits.y) >> (bitOf(off) & 31u) & 1u) == 1u; }

/// Those on the plane through x, `step` pixels apart, and between one and the next.
Around onPlane(ivec2 pixel, ivec2 size, int step, vec3 x, vec3 n) {
  Around set = Around(uvec2(0u));
  for (int i = 0; i < (2 * kReach + 1) * (2 * kReach + 1); ++i) {
    const ivec2 off = ivec2(i % (2 * kReach + 1), i / (2 * kReach + 1)) - kReach;
    bool on = isOnPlane(pixel + step * off, size, x, n);
    if (step > 1) on = on && isOnPlane(pixel + step * off - sign(off), size, x, n);
    const uint bit = uint(on) << (uint(i) & 31u);
    set.bits |= i < 32 ? uvec2(bit, 0u) : uvec2(0u, bit);
  }
  return set;
}

/// Whether the pixel and all between it and one around it are of the set.
bool reaches(Around set, ivec2 off) {
  const int steps = max(abs(off.x), abs(off.y));
  bool all = holds(set, off);
  for (int i = 1; i < steps; ++i) all = all && holds(set, ivec2(round(vec2(off * i) / float(steps))));
  return all;
}

/// Whether a pixel's own share stays: where all around met the same, in the light or in the dark, no mean would be
/// another one.
bool stays(ivec2 pixel, ivec2 size, vec4 share) {
  bool same = true;
  for (int i = 0; i < 4; ++i) {
    const ivec2 corner = clamp(pixel + kReach * (2 * ivec2(i & 1, i >> 1) - 1), ivec2(0), size - 1);
    same = same && texelFetch(poolShare, corner, 0) == share;
  }
  return same;
}

/// Pixels opposite each other are taken together, so that a slope stays as steep as it is.
vec3 shareAround(ivec2 pixel, ivec2 size, vec4 own) {
  const vec3 x = positionAt(pixel), n = normalAt(pixel);
#if LPV_REFLECTED
  const int step = isOnLattice(pixel) ? params.spacing : 1;
  const Around plane = onPlane(pixel, size, step, x, n);
  vec4 sum = own.w * vec4(own.rgb, 1.0);
#else
  vec4 sum = vec4(own.rgb, 1.0);
#endif
  const int width = 2 * kReach + 1;
  for (int i = 0; i < (width * width) / 2; ++i) {
    const ivec2 off = ivec2(i % width, i / width) - kReach;
#if LPV_REFLECTED
    if (!reaches(plane, off) || !reaches(plane, -off)) continue;
    const vec4 a = texelFetch(poolShare, pixel + step * off, 0), b = texelFetch(poolShare, pixel - step * off, 0);
    if (min(a.w, b.w) <= 0.0) continue;
    sum += a.w * vec4(a.rgb, 1.0) + b.w * vec4(b.rgb, 1.0);
#else
    const vec4 a = shareOnPlane(pixel + off, size, x, n), b = shareOnPlane(pixel - off, size, x, n);
    if (min(a.w, b.w) <= 0.0) continue;
    sum += 2.0 * weightOf(a, b, own) * vec4(0.5 * (a.rgb + b.rgb), 1.0);
#endif
  }
  return sum.rgb / sum.w;
}

void main() {
  const ivec2 size = imageSize(nearField), tiles = (size + kNearFieldTile - 1) / kNearFieldTile;
  const int tile = params.first + int(gl_WorkGroupID.x);
  const ivec2 pixel = kNearFieldTile * ivec2(tile % tiles.x, tile / tiles.x) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  const vec4 known = imageLoad(nearField, pixel);
  if (known.w <= 0.0) return;
  const vec4 own = texelFetch(poolShare, pixel, 0);
  if (own.w == kNoShare) return;  // it lies between others
  const vec3 share = own.w <= 0.0 || stays(pixel, size, own) ? own.rgb : shareAround(pixel, size, own);
  imageStore(nearField, pixel, vec4(known.rgb + texelFetch(poolLight, pixel, 0).rgb * share, known.w));
}
