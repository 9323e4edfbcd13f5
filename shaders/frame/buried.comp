// Pixels whose rays would begin behind what the camera sees. Rasterizers put corners on a grid of 1/256 of a pixel, so where a
// surface is at a pixel's middle is known to a part of a pixel; beside a crease that may be behind the next surface, or in a
// crack between two that touch, where it is as bright as it likes. In front of a surface the way from the eye is free. So a
// pixel is buried if something that the camera sees lies between a place some way before it and where its rays begin; it
// is listed with a depth that is nearer by as little as helps (drawn by frame/buried.vert). A thread has a pixel.
#include "layout.h"
#include "common/octahedral.glsl"
#include "frame/position.glsl"
#include "visibility/occluders.glsl"
#include "visibility/first_hit.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kBuriedParams) uniform BuriedBlock { BuriedParams params; };
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;

layout(std430, binding = kBuried) buffer Buried {
  uvec4 header;  // pixels, of which params.most are kept
  vec4 buried[];  // where in the picture, depth
};

const float kBefore = 2.0;  // pixels: where the way is free
const int kSteps = 3;
const float kFirstStep = 1.0 / 512.0;  // of a pixel, towards the eye; each further one is kStepRatio of it
const float kStepRatio = 4.0;

/// Whether something is met on the way to where rays begin, of which the camera sees the side that is met.
bool isBuried(vec3 free, vec3 start, inout int rounds) {
  const Sight sight = firstHit(free, start, false, rounds);
  return sight.at < 1.0 && (texelFetch(occluders, sight.instance + 6).w & (sight.front ? 1u : 2u)) != 0u;
}

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, params.firstRow);
  if (any(greaterThanEqual(pixel, textureSize(surfaceDepth, 0)))) return;
  const float depth = texelFetch(surfaceDepth, pixel, 0).x;
  if (depth <= 0.0) return;
  const vec3 n = unitFromOctahedral(texelFetch(normal, pixel, 0).xy);
  const vec3 place = gridPosition(frame, vec2(pixel) + 0.5, depth), view = place - frame.eye;
  const float viewDepth = frame.depthScale / (depth + frame.depthOffset);
  const float across = viewDepth * length(frame.rayDown) * frame.pixelSize.y / length(view);  // a pixel, as a share of the way
  const vec3 free = frame.eye + max(1.0 - kBefore * across, 0.0) * view;
  int rounds = 0;
  if (!isBuried(free, rayStart(frame, place, n, depth), rounds)) return;
  float nearer = kFirstStep * across;
  for (int i = 0; i < kSteps; ++i, nearer *= kStepRatio) {
    const float moved = frame.depthScale / ((1.0 - nearer) * viewDepth) - frame.depthOffset;
    if (isBuried(free, rayStart(frame, frame.eye + (1.0 - nearer) * view, n, moved), rounds)) continue;
    const uint at = atomicAdd(header.x, 1u);
    if (at < uint(params.most)) buried[at] = vec4(vec2(pixel), moved, 0.0);
    return;
  }
}
