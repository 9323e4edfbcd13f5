// Adds what is seen of a pool of lights to the points of a list, and after the last pool puts the sum into the picture, or
// to the patches; or what each pool sends, and the share that arrives, into pictures of their own (near_field_filter.comp).
// Where all rays arrived, or none were sent, E is what it was: unshadowed light stays exact (ratio estimator: Heitz, Hill
// and McGuire 2018). Threads per point.
#include "layout.h"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"
#include "visibility/haze.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

const float kAlikeApart = 1.0;     // receivers that take the mean of what haze leaves: cells between them, at most,
const float kAlikeDepth = 0.03;    // and optical depth,
const float kAlikeNormals = 0.95;  // and the cosine between their normals, at least
const uint kFoursOfBlock = uint(kNearFieldBlockX * kNearFieldBlockY) / 4u;

#if !LPV_PATCHES
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp
layout(binding = kPoolLightOut, rgba32f) writeonly uniform image2D poolLight;
layout(binding = kPoolShareOut, rgba32f) writeonly uniform image2D poolShare;
#endif

#if !LPV_PATCHES
/// How much a share says, as ShadowParams.apart has it.
float worth(ShadowPoint p) {
  const float ofRay = dot(p.all.rgb, vec3(1.0 / 3.0)) / max(p.all.a, 1.0);
  return shadow.turns == 0 ? -1.0 : shadow.apart == 1 ? p.all.a : ofRay;
}
#endif

/// Of what a pool sends, what haze leaves: the mean of a receiver and those like it in its block of pixels, of which each has
/// weighed few points of many. Where all have weighed the same points, its own.
float leftByHaze(uint point, float own) {
  if (shadow.jitter == 0) return own;
  const uint four = point / 4u;
  const ivec2 pixel = receiverOf(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel), x = receiverPosition(pixel);
  const float apart = min(kAlikeApart, kAlikeDepth / hazeExtinction());
  vec2 sum = vec2(own, 1.0);
  for (uint i = four - min(four, kFoursOfBlock - 1u); i < min(four + kFoursOfBlock, list.count); ++i) {
    if (blockOf(i) != blockOf(four)) continue;
    for (uint other = 4u * i; other < 4u * i + 4u; ++other) {
      const float left = shadowPoints[other].sum.a;
      const ivec2 beside = receiverOf(points[i][other % 4u]);
      if (other == point || left <= 0.0 || distance(receiverPosition(beside), x) > apart) continue;
      if (dot(receiverNormal(beside), n) >= kAlikeNormals) sum += vec2(left, 1.0);
    }
  }
  return sum.x / sum.y;
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  ShadowPoint p = shadowPoints[point];
  if (p.sum.a > 0.0) p.light.rgb = mix(p.asked.rgb, p.light.rgb, leftByHaze(point, p.sum.a));
  const vec3 seen = mix(p.seen.rgb / max(p.all.rgb, vec3(1e-30)), vec3(1.0), equal(p.seen.rgb, p.all.rgb));
  const vec3 arrives = seen * (p.light.rgb - p.asked.rgb) + p.known.rgb;
  const vec3 share = mix(arrives / max(p.light.rgb, vec3(1e-30)), seen, equal(p.asked.rgb, vec3(0.0)));
  const ivec2 pixel = receiverOf(points[four][point % 4u]);
#if !LPV_PATCHES
  if (shadow.apart > 0) {
    imageStore(poolLight, pixel, p.light);
    imageStore(poolShare, pixel, vec4(share, worth(p)));
    return;
  }
#endif
  const vec3 sum = p.light.rgb * share + (shadow.pool > 0 ? p.sum.rgb : vec3(0.0));
  shadowPoints[point].sum.rgb = sum;  // others read a
#if !LPV_PATCHES && LPV_APART
  const vec3 sent = p.light.rgb + (shadow.pool > 0 ? p.sent.rgb : vec3(0.0));
  shadowPoints[point].sent.rgb = sent;
#endif
  if (shadow.pool + 1 < shadow.pools) return;
#if LPV_PATCHES
  if (shadow.foldTurns > 0) {  // of a piece: what others reflect to it
    patches[pixel.x].arriving[0] = vec4(sum, 0.0);
    patches[pixel.x].arriving[1] = vec4(0.0);
  } else {
    patches[pixel.x].direct = vec4(sum, 0.0);
  }
#elif LPV_APART
  imageStore(nearField, pixel, vec4(sum, dot(sent, vec3(1.0 / 3.0))));
#else
  imageStore(nearField, pixel, vec4(sum, imageLoad(nearField, pixel).w));
#endif
}
