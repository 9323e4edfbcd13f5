// Adds what is seen of a pool of lights to the points of a list, and after the last pool puts the sum into the picture, or
// to the patches. Where all rays arrived, or none were sent, E is what it was: unshadowed light stays exact
// (ratio estimator: Heitz, Hill and McGuire 2018). Threads per point.
#include "layout.h"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

#if !LPV_PATCHES
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp
layout(binding = kReflectedLightOut, rgba32f) writeonly uniform image2D reflectedLight;
layout(binding = kReflectedShareOut, rgba32f) writeonly uniform image2D reflectedShare;
#endif

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const ShadowPoint p = shadowPoints[point];
  const vec3 share = mix(p.seen.rgb / max(p.all.rgb, vec3(1e-30)), vec3(1.0), equal(p.seen.rgb, p.all.rgb));
  const bool last = shadow.pool + 1 == shadow.pools, apart = last && shadow.apart == 1;
  const vec3 sum = (apart ? vec3(0.0) : p.light.rgb * share) + (shadow.pool > 0 ? p.sum.rgb : vec3(0.0));
  shadowPoints[point].sum = vec4(sum, 0.0);
  if (!last) return;
  const ivec2 pixel = unpackedPixel(points[four][point % 4u]);
#if LPV_PATCHES
  patches[pixel.x].direct = vec4(sum, 0.0);
#else
  if (apart) {
    imageStore(reflectedLight, pixel, p.light);
    imageStore(reflectedShare, pixel, vec4(share, p.all.a > 0.0 ? 1.0 : 0.0));
  }
  imageStore(nearField, pixel, vec4(sum, imageLoad(nearField, pixel).w));
#endif
}
