// What the patches of the surfaces reflect to the points that near_field.comp has listed, as if nothing lay between: the
// last pool of lights (shadow_rays.comp). A patch is taken for a disc, as in patchWeight of visibility/patches.glsl. Threads
// per point.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const ivec2 pixel = unpackedPixel(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel), x = receiverPosition(pixel) + kShadowOffset * n;
  vec3 sum = vec3(0.0);
  for (int i = 0; i < shadow.pointCount; ++i) {
    const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
    const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
    const vec3 d = place.xyz - x;
    const float r2 = dot(d, d), area = -emits.w;
    const float weight = max(-dot(emits.xyz, d), 0.0) * max(dot(n, d), 0.0) / max(r2 * (r2 + area / kPi), 1e-12);
    sum += place.w * weight * texelFetch(lightPoints, kLightPointTexels * i + 2).rgb;
  }
  begin(point, sum);
}
