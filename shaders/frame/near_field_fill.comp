// What surfaces reflect to pixels between those of a lattice: the mean of their cell's corners. A thread has a pixel.
#include "layout.h"

layout(local_size_x = kNearFieldTile, local_size_y = kNearFieldTile) in;

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp
#include "frame/plane.glsl"
#include "frame/lattice.glsl"

void main() {
  const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
  if (any(greaterThanEqual(pixel, imageSize(nearField)))) return;
  const float weight = imageLoad(nearField, pixel).w;
  if (weight <= 0.0 || !liesBetween(pixel)) return;
  const LatticeCell cell = cellOf(pixel);
  const vec3 above = mix(imageLoad(nearField, cell.low).rgb, imageLoad(nearField, ivec2(cell.high.x, cell.low.y)).rgb, cell.at.x);
  const vec3 below = mix(imageLoad(nearField, ivec2(cell.low.x, cell.high.y)).rgb, imageLoad(nearField, cell.high).rgb, cell.at.x);
  imageStore(nearField, pixel, vec4(mix(above, below, cell.at.y), weight));
}
