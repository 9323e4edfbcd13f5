// Pieces of folds, and the patches that stand for them. LPV_STEP:
//   0: what comes to a patch from the lights is what comes to its pieces in the mean
//   1: what pieces send, as long as nobody has looked from them: what comes to their patch from others comes to each
//   2: the same once they have been looked from
//   3: what a patch sends is what its pieces send in the mean
//   4: what comes to pieces from each other: nothing at first, since what their patch sends is too much for a pocket, which
//      keeps it for long; then by what they send by now
//   5: how much all pieces of a patch up to each send, which rays go by; 3 does that, too
// A thread has a patch in steps 0, 3 and 5, a piece in 1, 2 and 4.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/patches.glsl"
#ifndef LPV_STEP
#error "LPV_STEP: 0 to 5"
#endif

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPieceLights) buffer PieceLights { vec4 pieceLights[]; };
layout(std430, binding = kPatchLights) buffer Lights { vec4 lights[]; };

#if LPV_STEP == 4
layout(std430, binding = kFoldHits) readonly buffer FoldHits { int foldHits[]; };

void main() {
  const int i = params.first + int(gl_GlobalInvocationID.x), piece = params.count + i;
  if (i >= params.pieces) return;
  vec3 all = vec3(0.0);
  for (int turn = 0; turn < params.foldTurns; ++turn) {
    vec3 sum = vec3(0.0);
    int rays = 0;
    for (int k = 0; k < kFoldRays; ++k) {
      const int hit = foldHits[(i * params.foldTurns + turn) * kFoldRays + k];
      rays += hit == kNoRay ? 0 : 1;
      sum += hit >= 0 ? pieceLights[max(hit, 0)].rgb : vec3(0.0);
    }
    all += kPi / float(max(rays, 1) * params.foldTurns) * sum;
  }
  if (params.bounce == 0) patches[piece].arriving[0].rgb = max(patches[piece].arriving[0].rgb - all, vec3(0.0));
  patches[piece].arriving[1].rgb = params.bounce > 0 ? all : vec3(0.0);
}
#elif LPV_STEP == 1 || LPV_STEP == 2
void main() {
  const int i = params.first + int(gl_GlobalInvocationID.x), piece = params.count + i;
  if (i >= params.pieces) return;
#if LPV_STEP == 1
  const int of = int(patches[piece].of);
  const vec3 reflected = max(patches[of].arriving[params.lastBounce & 1].rgb - patches[of].direct.rgb, vec3(0.0));
#else
  const vec3 reflected = patches[piece].arriving[0].rgb + patches[piece].arriving[1].rgb;
#endif
  pieceLights[i] = vec4(patches[piece].albedo.rgb * (patches[piece].direct.rgb + reflected) / kPi, 0.0);
}
#else
vec3 ofPiece(int i) {
#if LPV_STEP == 0
  return patches[params.count + i].direct.rgb;
#else
  return pieceLights[i].rgb;
#endif
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count || patches[a].corners[1].w >= 0.0) return;
  const int first = int(patches[a].normal.w), end = first + int(patches[a].albedo.w);
  vec4 sum = vec4(0.0);
  for (int i = first; i < end; ++i) {
    sum += patches[params.count + i].place.w * vec4(ofPiece(i), 1.0);
#if LPV_STEP != 0
    patches[params.count + i].wanted = dot(sum.rgb, vec3(1.0));
#endif
  }
#if LPV_STEP == 5
  return;
#endif
  if (sum.w <= 0.0) return;
  const vec3 mean = sum.rgb / sum.w;
#if LPV_STEP == 0
  patches[a].direct.rgb = mean;
#else
  const float brightness = max(max(mean.r, mean.g), mean.b);
  lights[kLightPointTexels * a].w = patches[a].place.w * brightness;
  lights[kLightPointTexels * a + 2].rgb = brightness > 0.0 ? mean / brightness : vec3(0.0);
#endif
}
#endif
