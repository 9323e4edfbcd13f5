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

/// Both ways the same size (patch_balance.comp).
void say(int a, int b, float part, bool between) {
  if (between == (part < 0.0)) return;
  exchange[a * params.stride + b] = -part;
  exchange[b * params.stride + a] = -part;
}

void main() {
  const int eights = (params.count + 7) / 8, index = params.first + int(gl_GlobalInvocationID.x);
  const int a = index / eights, begin = 8 * (index % eights);
  if (a >= params.count || begin + 7 <= a) return;
  // Few pairs pass the box of all lights, and these are asked about together: llvmpipe goes through what any of eight
  // threads needs.
  uint near = 0u;
  for (int b = max(begin, a + 1); b < min(begin + 8, params.count); ++b) {
    const float part = exchange[a * params.stride + b];
    if (part == 0.0) continue;
    const vec3 from = placeTowards(a, b, 0);
    const SegmentBox segment = segmentBox(from, placeTowards(b, a, 0) - from, kTopMargin);
    if (meetsBox(params.lightsLow.xyz, params.lightsHigh.xyz, segment, 1.0)) {
      near |= 1u << (b - begin);
    } else {
      say(a, b, part, false);
    }
  }
  for (; near != 0u; near &= near - 1u) {
    const int b = begin + findLSB(near);
    say(a, b, exchange[a * params.stride + b], meetsLight(placeTowards(a, b, 0), placeTowards(b, a, 0)));
  }
}
