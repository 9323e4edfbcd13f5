// Which patches see each other (MATHS.md 3d): a bit for each pair, by one ray from middle to middle. A thread has eight
// partners of one patch; of each pair the lower patch sends the ray. LPV_PAIR_COLOURS: instead of a bit a pair has what
// light keeps on its way, per colour (packedShare).
#include "layout.h"
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchPairs) buffer Pairs { uint pairs[]; };

#ifndef LPV_PAIR_COLOURS
#error "LPV_PAIR_COLOURS: 0 or 1"
#elif LPV_PAIR_COLOURS
void connect(int a, int b, vec3 share) { pairs[a * params.words + b] = packedShare(share); }
#else
void connect(int a, int b, vec3 share) {
  if (dot(share, vec3(1.0)) >= 1.5) atomicOr(pairs[a * params.words + b / 32], 1u << uint(b % 32));
}
#endif

void main() {
  const int eights = (params.count + 7) / 8, index = params.first + int(gl_GlobalInvocationID.x);
  const int a = index / eights, begin = 8 * (index % eights);
  if (a >= params.count || begin + 7 <= a) return;
  const vec3 x = patches[a].place.xyz + kShadowOffset * patches[a].normal.xyz;
  for (int b = max(begin, a + 1); b < min(begin + 8, params.count); ++b) {
    if (patchWeight(patches[b], x, patches[a].normal.xyz) <= 0.0) continue;
    const vec3 y = patches[b].place.xyz + kShadowOffset * patches[b].normal.xyz;
    const vec3 share = transmitted(x, y, -1);
    if (share == vec3(0.0)) continue;
    connect(a, b, share);
    connect(b, a, share);
  }
}
