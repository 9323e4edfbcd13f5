// Which share of a pool's light arrives at pixels of a picture, and whether they are on a plane with another one. Whoever
// includes this has FrameParams as `frame`.
#include "frame/plane.glsl"

layout(binding = kPoolShare) uniform sampler2D poolShare;

/// A pixel's share, its rays 0 where it is not on the plane through x.
vec4 shareOnPlane(ivec2 pixel, ivec2 size, vec3 x, vec3 n) {
  return isOnPlane(pixel, size, x, n) ? texelFetch(poolShare, pixel, 0) : vec4(0.0);
}
