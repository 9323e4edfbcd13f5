// Smooths what haze scatters towards the camera over pixels whose views are as long and that differ by no more than chance:
// edges of shadows in the haze stay where they are. A thread has a pixel.
#include "layout.h"
#include "common/colour.glsl"
#include "frame/position.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kHazeParams) uniform HazeBlock { HazeParams params; };
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;
layout(binding = kHazeSum) uniform sampler2D hazeSum;
layout(binding = kHazeOut, rgba32f) writeonly uniform image2D haze;

const int kReach = 3;             // pixels on each side
const float kSameLength = 0.05;   // of a view, as a share of it
const float kByChance = 3.0;      // variances: a pixel and the mean of two others differ by one and a half of them, and often by twice that
const float kDoubt = 1e-3;        // of what is found: what chance may do at least, since few rays do not know

float depthAt(ivec2 pixel) { return max(texelFetch(surfaceDepth, pixel, 0).x, texelFetch(emitterDepth, pixel, 0).x); }

/// Where a pixel's view ends, metres; 0: nowhere.
float lengthAt(ivec2 pixel) {
  const float depth = depthAt(pixel);
  return depth > 0.0 ? frame.depthScale / (depth + frame.depthOffset) : 0.0;
}

/// Whether its view ends at a light: what haze scatters forward ends there, too.
bool showsLight(ivec2 pixel) {
  const float emitter = texelFetch(emitterDepth, pixel, 0).x;
  return emitter > 0.0 && emitter >= texelFetch(surfaceDepth, pixel, 0).x;
}

bool isAlike(ivec2 a, ivec2 b) {
  return showsLight(a) == showsLight(b) && abs(lengthAt(a) - lengthAt(b)) <= kSameLength * lengthAt(b);
}

vec3 foundAt(ivec2 pixel) { return texelFetch(hazeSum, pixel, 0).rgb / float(params.turns * kHazeRays); }

/// Of a pixel's mean.
float varianceAt(ivec2 pixel) {
  const vec4 mean = texelFetch(hazeSum, pixel, 0) / float(params.turns * kHazeRays);
  const float doubt = kDoubt * largest(mean.rgb);
  return mean.a / float(params.turns * kHazeRays) + doubt * doubt;
}

/// Over the pixels around, or its own where that is more: what one ray alone has found is grain.
float varianceAround(ivec2 pixel, ivec2 size) {
  float sum = 0.0;
  for (int i = 0; i < 9; ++i) sum += varianceAt(clamp(pixel + ivec2(i % 3, i / 3) - 1, ivec2(0), size - 1));
  return max(sum / 9.0, varianceAt(pixel));
}

/// Pixels opposite each other are taken together, so that a slope stays as steep as it is.
vec3 smoothed(ivec2 pixel, ivec2 size) {
  const vec3 own = foundAt(pixel);
  const float variance = varianceAround(pixel, size) + 1e-20;
  vec4 sum = vec4(own, 1.0);
  const int width = 2 * kReach + 1;
  for (int i = 0; i < (width * width) / 2; ++i) {
    const ivec2 off = ivec2(i % width, i / width) - kReach, a = pixel + off, b = pixel - off;
    if (any(lessThan(min(a, b), ivec2(0))) || any(greaterThanEqual(max(a, b), size))) continue;
    if (!isAlike(a, pixel) || !isAlike(b, pixel)) continue;
    const vec3 between = 0.5 * (foundAt(a) + foundAt(b));
    const float bent = largest(abs(between - own));
    sum += 2.0 * exp(-0.5 * bent * bent / (kByChance * variance)) * vec4(between, 1.0);
  }
  return max(sum.rgb / sum.w, vec3(0.0));
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = imageSize(haze);
  if (any(greaterThanEqual(pixel, size))) return;
  imageStore(haze, pixel, vec4(smoothed(pixel, size), 1.0));
}
