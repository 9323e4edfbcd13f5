// Which pairs of patches have a light between them: it swallows what they exchange, whose sign says so. A thread has eight
// partners of one patch; the lower patch of a pair answers for both. Made again when lights move, while what patches
// exchange stands.
#include "layout.h"
#define LPV_TRANSPARENT 0
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) buffer Exchange { float exchange[]; };

vec3 beside(int i) { return patches[i].place.xyz + kShadowOffset * patches[i].normal.xyz; }

void main() {
  const int eights = (params.count + 7) / 8, index = params.first + int(gl_GlobalInvocationID.x);
  const int a = index / eights, begin = 8 * (index % eights);
  if (a >= params.count || begin + 7 <= a) return;
  for (int b = max(begin, a + 1); b < min(begin + 8, params.count); ++b) {
    const int there = a * params.count + b, back = b * params.count + a;
    if (exchange[there] == 0.0 && exchange[back] == 0.0) continue;
    const float sign = meetsLight(beside(a), beside(b)) ? -1.0 : 1.0;
    exchange[there] = sign * abs(exchange[there]);
    exchange[back] = sign * abs(exchange[back]);
  }
}
