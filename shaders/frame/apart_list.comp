// Lists the pixels with samples that are lit as no pixel's middle (frame/subpixels.comp), so that light is found at the places
// of these. A thread has a block of pixels.
#include "layout.h"
#include "frame/position.glsl"
#include "frame/point_list.glsl"
#include "frame/subpixels.glsl"

layout(local_size_x = kNearFieldGroup) in;

layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kSubpixelsApart) uniform sampler2D apartSubpixels;

const ivec2 kBlock = ivec2(kNearFieldBlockX, kNearFieldBlockY);

void main() {
  const ivec2 size = textureSize(apartSubpixels, 0), blocks = (size + kBlock - 1) / kBlock;
  const int block = params.first + int(gl_GlobalInvocationID.x);
  if (block >= blocks.x * blocks.y) return;
  const ivec2 corner = kBlock * ivec2(block % blocks.x, block / blocks.x);
  uint bits = 0u;
  for (int i = 0; i < kBlock.x * kBlock.y; ++i) {
    const ivec2 pixel = corner + ivec2(i % kBlock.x, i / kBlock.x);
    if (all(lessThan(pixel, size)) && countOf(texelFetch(apartSubpixels, pixel, 0)) > 0) bits |= 1u << i;
  }
  listPoints(bits, corner, ivec2(1));
}
