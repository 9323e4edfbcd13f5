// What surfaces reflect to the pixels of a picture: what would come with nothing in the way, times the share that arrives,
// which is the mean of what pixels around found with few rays each (shadow_rays.comp: neighbours send theirs elsewhere).
// Only pixels of the same plane count. A thread has a pixel.
#include "layout.h"
#include "common/octahedral.glsl"
#include "frame/position.glsl"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kNormal) uniform sampler2D normal;
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kReflectedLight) uniform sampler2D reflectedLight;
layout(binding = kReflectedShare) uniform sampler2D reflectedShare;
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp

const int kReach = 3;                // pixels on each side
const float kLeastCosine = 0.9;      // between normals
const float kOffPlane = 0.05;        // as a share of the distance

vec3 positionAt(ivec2 pixel) { return gridPosition(frame, vec2(pixel) + 0.5, texelFetch(surfaceDepth, pixel, 0).x); }
vec3 normalAt(ivec2 pixel) { return unitFromOctahedral(texelFetch(normal, pixel, 0).xy); }

void main() {
  const ivec2 size = imageSize(nearField), tiles = (size + kNearFieldTile - 1) / kNearFieldTile;
  const int tile = params.first + int(gl_WorkGroupID.x);
  const ivec2 pixel = kNearFieldTile * ivec2(tile % tiles.x, tile / tiles.x) + ivec2(gl_LocalInvocationID.xy);
  if (any(greaterThanEqual(pixel, size))) return;
  const vec4 known = imageLoad(nearField, pixel);
  if (known.w <= 0.0) return;
  const vec3 x = positionAt(pixel), n = normalAt(pixel);
  vec4 sum = vec4(0.0);
  for (int dy = -kReach; dy <= kReach; ++dy) {
    for (int dx = -kReach; dx <= kReach; ++dx) {
      const ivec2 other = clamp(pixel + ivec2(dx, dy), ivec2(0), size - 1);
      const vec4 share = texelFetch(reflectedShare, other, 0);
      const vec3 d = positionAt(other) - x;
      const bool same = dot(normalAt(other), n) >= kLeastCosine && abs(dot(d, n)) <= kOffPlane * length(d) + 1e-6;
      sum += same ? share.w * vec4(share.rgb, 1.0) : vec4(0.0);
    }
  }
  const vec3 light = texelFetch(reflectedLight, pixel, 0).rgb;
  const vec3 share = sum.w > 0.0 ? sum.rgb / sum.w : vec3(1.0);
  imageStore(nearField, pixel, vec4(known.rgb + light * share, known.w));
}
