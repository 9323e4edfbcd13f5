// Smooths what the lobes of a picture reflect over pixels of one surface, further the rougher it is: what a few rays see of
// a broad lobe is grain, which neighbours have otherwise. Lights have edges: what they send is smoothed over pixels that
// differ by no more than chance. What is nearly a mirror stays as it is. Leaves the radiance, and
// in a what of other light is reflected (Lobe::diffuse). A thread has a pixel.
#include "layout.h"
#include "common/sh.glsl"
#include "common/colour.glsl"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/gloss.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(binding = kGlossLights) uniform sampler2D ofLights;
layout(binding = kGlossSurfaces) uniform sampler2D ofSurfaces;
layout(binding = kGlossOut, rgba32f) writeonly uniform image2D gloss;

const float kLeastCosineBeside = 0.95;  // between normals
const float kOffPlane = 0.05;           // as a share of the distance
const float kSameRoughness = 0.05;

/// Pixels on each side.
int reachOf(float roughness) { return roughness < 0.08 ? 0 : roughness < 0.2 ? 2 : roughness < 0.4 ? 3 : 4; }

bool isBeside(ivec2 pixel, vec3 x, vec3 n, float roughness) {
  const vec3 d = surfacePosition(frame, pixel) - x;
  return dot(n, surfaceNormal(pixel)) >= kLeastCosineBeside && abs(dot(n, d)) <= kOffPlane * length(d) + 1e-4 &&
         abs(texelFetch(material, pixel, 0).x - roughness) <= kSameRoughness;
}

/// A pixel and one beside it meet halfway, each by as much as the other: what one loses the other has, so that the mean over
/// a surface stays, however uneven the grain is. By how much goes by what chance does to both.
vec3 smoothed(ivec2 pixel, ivec2 size) {
  const float roughness = texelFetch(material, pixel, 0).x;
  const int reach = reachOf(roughness);
  const vec3 x = surfacePosition(frame, pixel), n = surfaceNormal(pixel);
  const vec4 own = texelFetch(ofLights, pixel, 0);
  vec3 lights = vec3(0.0);
  vec4 surfaces = vec4(0.0);
  float whole = 0.0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      const float near = exp(-float(dx * dx + dy * dy) / max(float(reach * reach), 1.0));
      whole += near;
      const ivec2 at = pixel + ivec2(dx, dy);
      if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
      const vec4 there = texelFetch(ofLights, at, 0);
      if (there.a < 0.0 || (at != pixel && !isBeside(at, x, n, roughness))) continue;
      const float off = largest(abs(there.rgb - own.rgb)), both = own.a + there.a + 1e-12;
      lights += near * exp(-max(off * off / both - 1.0, 0.0)) * (there.rgb - own.rgb);
      surfaces += near * vec4(texelFetch(ofSurfaces, at, 0).rgb, 1.0);
    }
  }
  return own.rgb + lights / whole + surfaces.rgb / surfaces.a;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(surfaceDepth, 0);
  if (any(greaterThanEqual(pixel, size))) return;
  if (texelFetch(ofLights, pixel, 0).a < 0.0) {
    imageStore(gloss, pixel, vec4(0.0, 0.0, 0.0, 1.0));
    return;
  }
  const Lobe lobe = lobeAt(frame, pixel);
  imageStore(gloss, pixel, vec4(lobe.all * smoothed(pixel, size), lobe.diffuse));
}
