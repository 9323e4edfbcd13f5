// What surfaces reflect to the points of a stream's frame (near_field.comp) that were evaluated in a pass: what would come
// with nothing in the way, times the share that arrives. As in near_field_filter.comp, a point's own rays are few, so the
// share is the mean over points around that are on the same plane. Here these are of the first pass, kNearFieldSpacing
// pixels apart: light of all surfaces has no edges that this would blur. A thread has a point of the pass.
#include "layout.h"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
#include "frame/plane_shares.glsl"
/// rgb: what would come with nothing in the way, then E; a: 1 then (near_field.comp).
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;

const int kReach = 2;  // points of the first pass to each side

/// How much one of the first points counts, by the pixels to it.
float nearness(ivec2 pixels) {
  const vec2 away = abs(vec2(pixels)) / float((kReach + 1) * params.spacing);
  return max(1.0 - away.x, 0.0) * max(1.0 - away.y, 0.0);
}

vec3 shareAround(ivec2 pixel, ivec2 size, vec4 own) {
  const vec3 x = positionAt(pixel), n = normalAt(pixel);
  const ivec2 nearest = (pixel + params.spacing / 2) / params.spacing * params.spacing;
  vec4 sum = own.w * vec4(own.rgb, 1.0);
  for (int i = 0; i < (2 * kReach + 1) * (2 * kReach + 1); ++i) {
    const ivec2 other = nearest + params.spacing * (ivec2(i % (2 * kReach + 1), i / (2 * kReach + 1)) - kReach);
    if (other == pixel) continue;
    const vec4 share = shareOnPlane(other, size, x, n);
    sum += nearness(other - pixel) * max(share.w, 0.0) * vec4(share.rgb, 1.0);
  }
  return sum.rgb / sum.w;
}

void main() {
  const ivec2 size = imageSize(nearField);
  const int s = params.stride.x + params.stride.y;  // as in near_field.comp
  const ivec2 apart = s == 0 ? ivec2(params.spacing) : params.stride.x > 0 ? ivec2(2 * s) : ivec2(s, 2 * s);
  const ivec2 pixel = params.stride + apart * ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  const vec4 own = texelFetch(poolShare, pixel, 0);
  if (own.w == kNoShare) return;  // it lies between others
  const vec3 share = own.w <= 0.0 ? own.rgb : shareAround(pixel, size, own);
  imageStore(nearField, pixel, vec4(imageLoad(nearField, pixel).rgb * share, 1.0));
}
