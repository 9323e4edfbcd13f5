// Whether pixels of a picture are on a plane with another one. Whoever includes this has FrameParams as `frame`.
#include "common/octahedral.glsl"
#include "frame/position.glsl"

layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;

const float kLeastPlaneCosine = 0.9;  // between normals
const float kOffPlane = 0.05;         // as a share of the distance

vec3 positionAt(ivec2 pixel) { return gridPosition(frame, vec2(pixel) + 0.5, texelFetch(surfaceDepth, pixel, 0).x); }
vec3 normalAt(ivec2 pixel) { return unitFromOctahedral(texelFetch(normal, pixel, 0).xy); }

/// Whether a pixel of the picture is on the plane through x.
bool isOnPlane(ivec2 pixel, ivec2 size, vec3 x, vec3 n) {
  if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, size))) return false;
  const vec3 d = positionAt(pixel) - x;
  return dot(normalAt(pixel), n) >= kLeastPlaneCosine && abs(dot(d, n)) <= kOffPlane * length(d) + 1e-6;
}
