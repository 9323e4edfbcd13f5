// After the last turn of gloss_rays.comp: what the lobe of each pixel reflects of lights, and of surfaces, over what it
// would reflect of even light of radiance 1, so that neighbours with other albedo can be smoothed together. A thread has a
// pixel.
#include "layout.h"
#include "common/sh.glsl"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/gloss.glsl"
#include "frame/gloss_points.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kGlossParams) uniform GlossBlock { GlossParams params; };
layout(binding = kGlossMet) uniform sampler2D metIrradiance;
layout(binding = kGlossOut, rgba32f) writeonly uniform image2D lightsOut;
layout(binding = kGlossSurfacesOut, rgba32f) writeonly uniform image2D surfacesOut;

const float kLeastCosineBeside = 0.95;
const float kApart = 0.05;           // of the way of the light, about what lies between pixels of a mirror

/// E where the pixel's reflections met a surface: of its own few rays to lights, and of those from places close by that
/// neighbours' reflections met. `at`: of one of the row of pictures.
vec3 irradianceAt(ivec2 at, GlossPoint p, ivec2 size) {
  vec4 sum = vec4(0.0);
  const int first = at.x - at.x % size.x;
  for (int dy = -kGlossReach; dy <= kGlossReach; ++dy) {
    for (int dx = -kGlossReach; dx <= kGlossReach; ++dx) {
      const ivec2 there = at + ivec2(dx, dy);
      if (there.y < 0 || there.y >= size.y || there.x < first || there.x >= first + size.x) continue;
      if (glossPoints[glossIndex(frame, there - ivec2(first, 0))].lights.a == 0.0) continue;
      const GlossPoint q = glossPoints[glossIndex(frame, there)];
      const vec3 d = q.place.xyz - p.place.xyz;
      if (q.place.a == 0.0 || dot(d, d) > kApart * kApart * p.place.a * p.place.a) continue;
      if (dot(q.normal.xyz, p.normal.xyz) < kLeastCosineBeside) continue;
      sum += vec4(texelFetch(metIrradiance, there, 0).rgb, 1.0);
    }
  }
  return sum.rgb / max(sum.a, 1.0);
}

void main() {
  const ivec2 at = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, kGlossReach), pixel = at + ivec2(0, params.bandRow);
  const ivec2 size = ivec2(pictureWidth(frame), params.bandRows);
  if (at.x >= size.x || at.y >= kGlossReach + params.rowsWanted) return;
  const GlossPoint first = glossPoints[glossIndex(frame, at)];
  const float turns = first.lights.a;
  if (turns == 0.0) {
    imageStore(lightsOut, pixel, vec4(0.0, 0.0, 0.0, -1.0));
    return;
  }
  const vec3 all = max(lobeAt(frame, pixel).all, vec3(1e-6)), lights = first.lights.rgb / turns;
  const float scale = max(max(all.r, all.g), all.b);
  vec3 surfaces = vec3(0.0);
  for (int i = 0; i < kGlossPlaces; ++i) {
    const ivec2 there = at + ivec2(i * size.x, 0);
    const GlossPoint p = glossPoints[glossIndex(frame, there)];
    if (p.place.a > 0.0) surfaces += p.met.rgb * p.met.a * irradianceAt(there, p, size);
  }
  imageStore(lightsOut, pixel, vec4(lights / all, varianceOf(first) / (scale * scale)));
  imageStore(surfacesOut, pixel, vec4(surfaces / (kPi * turns * float(kGlossRays)) / all, 0.0));
}
