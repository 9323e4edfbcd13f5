// What the patches of the surfaces reflect to the points that near_field.comp has listed, as if nothing lay between: the
// last pool of lights (shadow_rays.comp). Far patches are patchWeight of visibility/patches.glsl; beside them, and in
// corners, they are triangles. Threads per point.
#include "layout.h"
#include "common/sh.glsl"
#include "transport/polygons.glsl"
#include "visibility/patches.glsl"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

vec3 radianceOf(int i) {
  const float area = -texelFetch(lightPoints, kLightPointTexels * i + 1).w;
  return texelFetch(lightPoints, kLightPointTexels * i).w / area *
         texelFetch(lightPoints, kLightPointTexels * i + 2).rgb;
}

bool near(int i, vec3 x) {
  const vec3 d = texelFetch(lightPoints, kLightPointTexels * i).xyz - x;
  return dot(d, d) < -kNearPatch * texelFetch(lightPoints, kLightPointTexels * i + 1).w && patches[i].corners[0].w > 0.0;
}

vec3 farLight(vec3 x, vec3 n) {
  vec3 sum = vec3(0.0);
  for (int i = 0; i < shadow.pointCount; ++i) {
    const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
    const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
    const float weight = patchWeight(place.xyz - x, -emits.w, emits.xyz, n) / -emits.w;
    sum += near(i, x) ? vec3(0.0) : place.w * weight * texelFetch(lightPoints, kLightPointTexels * i + 2).rgb;
  }
  return sum;
}

vec3 nearLight(vec3 x, vec3 n) {
  vec3 sum = vec3(0.0);
  int i = 0;
  while (i < shadow.pointCount) {
    while (i < shadow.pointCount && !near(i, x)) ++i;  // by itself: llvmpipe goes through what a branch leaves out
    if (i >= shadow.pointCount) break;
    const vec4 corners[3] = patches[i].corners;
    sum += radianceOf(i) * triangleIrradiance(corners[0].xyz - x, corners[1].xyz - x, corners[2].xyz - x, n, 1.0);
    ++i;
  }
  return sum;
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const ivec2 pixel = unpackedPixel(points[four][point % 4u]);
  const vec3 n = receiverNormal(pixel), x = receiverPosition(pixel) + kShadowOffset * n;
  begin(point, farLight(x, n) + nearLight(x, n));
}
