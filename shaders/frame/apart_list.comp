// Lists the places of samples that are lit as no pixel's middle (frame/subpixels.comp), so that light is found there. A thread
// has a block of the pictures of places, which lie side by side.
#include "layout.h"
#include "frame/position.glsl"
#include "frame/point_list.glsl"
#include "frame/subpixels.glsl"

layout(local_size_x = kNearFieldGroup) in;

layout(std140, binding = kNearFieldParams) uniform NearFieldBlock { NearFieldParams params; };
layout(binding = kApartAlbedo) uniform sampler2D apartAlbedo;

const ivec2 kBlock = ivec2(kNearFieldBlockX, kNearFieldBlockY);

void main() {
  const ivec2 size = textureSize(apartAlbedo, 0), blocks = (size + kBlock - 1) / kBlock;
  const int block = params.first + int(gl_GlobalInvocationID.x);
  if (block >= blocks.x * blocks.y) return;
  const ivec2 corner = kBlock * ivec2(block % blocks.x, block / blocks.x);
  uint bits = 0u;
  for (int i = 0; i < kBlock.x * kBlock.y; ++i) {
    const ivec2 at = corner + ivec2(i % kBlock.x, i / kBlock.x);
    if (all(lessThan(at, size)) && countOf(texelFetch(apartAlbedo, at, 0)) > 0) bits |= 1u << i;
  }
  listPoints(bits, corner, ivec2(1));
}
