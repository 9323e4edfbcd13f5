// Automatic exposure (scene/tonemap.h): the mean lightness of the pixels that show a surface, brought to that of the
// key. Sums in a fixed order, so the same picture has the same exposure. LPV_FINISH 0: a sum per group of pixels;
// 1: one group adds them up.
#include "layout.h"
#include "common/tonemap.glsl"

#ifndef LPV_FINISH
#error "LPV_FINISH: 0 or 1"
#endif

layout(local_size_x = kExposureGroup) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(binding = kRadiance) uniform sampler2D radiance;
layout(std430, binding = kExposure) buffer Exposure {
  vec4 exposure;  // x: factor, y: stops
  vec4 sums[];    // x: of cube roots of luminance, y: pixels
};

shared vec2 partial[kExposureGroup];

vec2 pixelSum(int first) {
  const int width = textureSize(radiance, 0).x;
  vec2 sum = vec2(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < kExposurePixels; i += kExposureGroup) {
    const int pixel = first + i;
    if (pixel >= frame.pixels) break;
    const vec4 c = texelFetch(radiance, ivec2(pixel % width, pixel / width), 0);
    if (c.a > 0.0) sum += vec2(pow(luminanceOf(c.rgb), 1.0 / 3.0), 1.0);
  }
  return sum;
}

vec2 sumOfSums() {
  const int groups = (frame.pixels + kExposurePixels - 1) / kExposurePixels;
  vec2 sum = vec2(0.0);
  for (int i = int(gl_LocalInvocationID.x); i < groups; i += kExposureGroup) sum += sums[i].xy;
  return sum;
}

void main() {
#if LPV_FINISH
  partial[gl_LocalInvocationID.x] = sumOfSums();
#else
  const int group = int(frame.exposure.firstGroup) + int(gl_WorkGroupID.x);
  partial[gl_LocalInvocationID.x] = pixelSum(group * kExposurePixels);
#endif
  barrier();
  if (gl_LocalInvocationID.x != 0u) return;
  vec2 sum = vec2(0.0);
  for (int i = 0; i < kExposureGroup; ++i) sum += partial[i];
#if LPV_FINISH
  const float automatic = sum.x > 0.0 ? log2(frame.exposure.key) - 3.0 * log2(sum.x / sum.y) : 0.0;
  exposure.y = automatic + log2(frame.exposure.factor);
  exposure.x = exp2(exposure.y);
#else
  sums[group] = vec4(sum, 0.0, 0.0);
#endif
}
