// Adds the picture of a pool of lights (LPV_POOL of near_field.comp) to the near field, or begins it. A thread has a pixel.
#include "layout.h"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };  // first: of the pools
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;
layout(binding = kNearField) uniform sampler2D pool;
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(nearField)))) return;
  const float depth = texelFetch(surfaceDepth, pixel, 0).x, emitter = texelFetch(emitterDepth, pixel, 0).x;
  const bool hidden = depth <= 0.0 || (emitter > 0.0 && emitter >= depth);
  const vec3 before = params.first == 0 ? vec3(0.0) : imageLoad(nearField, pixel).rgb;
  imageStore(nearField, pixel, hidden ? vec4(0.0) : vec4(before + texelFetch(pool, pixel, 0).rgb, 1.0));
}
