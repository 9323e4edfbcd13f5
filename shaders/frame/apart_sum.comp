// Adds what a pixel shows that is not lit as a middle: samples at a few places, where light has been found
// (frame/apart_list.comp). A thread has a pixel.
#include "layout.h"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "frame/subpixels.glsl"
#include "frame/sent.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kSubpixelParams) uniform SubpixelBlock { SubpixelParams params; };

layout(binding = kApartAlbedo) uniform sampler2D apartAlbedo;
layout(binding = kApartLight) uniform sampler2D apartLight;
layout(binding = kApartPlace) uniform sampler2D apartPlace;
layout(binding = kApartNormal) uniform sampler2D apartNormal;
layout(binding = kSubpixelRadianceOut, rgba32f) uniform image2D radiance;
layout(binding = kSubpixelLightsOut, rgba32f) readonly uniform image2D lights;

const int kReach = 2;             // pixels
const float kRadius = 2.5;        // pixels: light farther away says nothing of this
const float kOffPlane = 0.5;      // pixels
const float kCosine = 0.9;

int pictureWidth() { return imageSize(radiance).x; }
int places() { return textureSize(apartAlbedo, 0).x / pictureWidth(); }

/// Of what would be there with nothing in the way, what arrives; `light`: as kApartLight.
float shareOf(vec4 light) { return light.a > 0.0 ? clamp(dot(light.rgb, vec3(1.0 / 3.0)) / light.a, 0.0, 1.0) : 1.0; }

/// Of a share, by chance, as in near_field_filter.comp.
float variance(float share) {
  return 0.5 * (share * (1.0 - share) + 0.25 / float(params.rays)) / float(params.rays);
}

/// The sum of the lights at a pixel's places that are on the same plane as another one, `place`, near it, and whose shares
/// differ by no more than chance.
vec4 lightsLike(vec3 place, vec3 n, float share, float footprint, ivec2 at) {
  vec4 sum = vec4(0.0);
  for (int i = 0; i < places(); ++i) {
    const ivec2 other = placeApart(at, i, pictureWidth());
    if (countOf(texelFetch(apartAlbedo, other, 0)) == 0) break;
    const vec3 apart = texelFetch(apartPlace, other, 0).xyz - place;
    const float cosine = dot(unitFromOctahedral(texelFetch(apartNormal, other, 0).xy), n);
    if (cosine < kCosine || abs(dot(apart, n)) > kOffPlane * footprint) continue;
    const vec4 light = texelFetch(apartLight, other, 0);
    const float differ = shareOf(light) - share;
    const float weight = max(1.0 - length(apart) / (kRadius * footprint), 0.0);
    sum += weight * exp(-0.5 * differ * differ / (variance(share) + variance(shareOf(light)))) * light;
  }
  return sum;
}

/// E at a place of the pixel at `at`: what would be there with nothing in the way, and of that the share that arrives there
/// and at places beside it. A place's own rays are few.
vec3 lightAround(ivec2 at, vec3 place, vec3 n, vec4 own) {
  const float footprint = distance(place, frame.eye) * length(frame.rayDown) * frame.pixelSize.y;
  const ivec2 end = ivec2(pictureWidth(), textureSize(apartAlbedo, 0).y) - 1;
  const ivec2 low = max(at - kReach, ivec2(0)), high = min(at + kReach, end);
  vec4 sum = vec4(0.0);
  for (int y = low.y; y <= high.y; ++y) {
    for (int x = low.x; x <= high.x; ++x) sum += lightsLike(place, n, shareOf(own), footprint, ivec2(x, y));
  }
  return sum.a > 0.0 ? own.a / sum.a * sum.rgb : own.rgb;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, params.firstWanted);
  if (pixel.x >= pictureWidth() || pixel.y >= params.endWanted) return;
  const ivec2 at = pixel - ivec2(0, params.firstRow);
  vec3 sum = vec3(0.0);
  for (int i = 0; i < places(); ++i) {
    const ivec2 there = placeApart(at, i, pictureWidth());
    const vec4 subpixels = texelFetch(apartAlbedo, there, 0);
    if (countOf(subpixels) == 0) break;
    const vec3 place = texelFetch(apartPlace, there, 0).xyz, n = unitFromOctahedral(texelFetch(apartNormal, there, 0).xy);
    const vec3 light = lightAround(at, place, n, texelFetch(apartLight, there, 0));
    const float share = float(countOf(subpixels)) / float(frame.samples);
    sum += share * sent(frame, pixel, codeOf(subpixels), place, subpixels.rgb, light);
  }
  // How much of the pixel is lights is known better than by the samples of surfaces. Where none of these met a surface, what
  // little there is of one counts as dark: it is darker than the light.
  const vec4 surfaces = imageLoad(radiance, pixel), inFront = imageLoad(lights, pixel);
  const float share = surfaces.a < 1.0 ? (1.0 - inFront.a) / (1.0 - surfaces.a) : 0.0;
  imageStore(radiance, pixel, vec4(share * (surfaces.rgb + sum) + inFront.rgb, 0.0));
}
