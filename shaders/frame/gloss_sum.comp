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
/// neighbours' reflections met; the nearest neighbour's, if none are close. `at`: in the first picture.
vec3 irradianceAt(ivec2 at, int picture, GlossPoint p, ivec2 size) {
  vec4 sum = vec4(0.0);
  vec3 nearest = vec3(0.0);
  int least = 1 << 20;
  for (int dy = -kGlossReach; dy <= kGlossReach; ++dy) {
    for (int dx = -kGlossReach; dx <= kGlossReach; ++dx) {
      const ivec2 beside = at + ivec2(dx, dy);
      if (any(lessThan(beside, ivec2(0))) || any(greaterThanEqual(beside, size))) continue;
      const int from = params.spacing == 1 ? picture : 0;
      const ivec2 there = beside + ivec2(from * size.x, 0);
      if (!isAsked(params, beside, from) || glossPoints[glossIndex(frame, beside)].lights.a == 0.0) continue;
      const GlossPoint q = glossPoints[glossIndex(frame, there)];
      if (q.place.a == 0.0) continue;
      const vec3 e = texelFetch(metIrradiance, there, 0).rgb, d = q.place.xyz - p.place.xyz;
      if (dx * dx + dy * dy < least) {
        least = dx * dx + dy * dy;
        nearest = e;
      }
      if (dot(d, d) > kApart * kApart * p.place.a * p.place.a) continue;
      if (dot(q.normal.xyz, p.normal.xyz) < kLeastCosineBeside) continue;
      sum += vec4(e, 1.0);
    }
  }
  return sum.a > 0.0 ? sum.rgb / sum.a : nearest;
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
    const GlossPoint p = glossPoints[glossIndex(frame, at + ivec2(i * size.x, 0))];
    if (p.place.a > 0.0) surfaces += p.met.rgb * p.met.a * irradianceAt(at, i, p, size);
  }
  imageStore(lightsOut, pixel, vec4(lights / all, varianceOf(first) / (scale * scale)));
  imageStore(surfacesOut, pixel, vec4(surfaces / (kPi * turns * float(kGlossRays)) / all, 0.0));
}
