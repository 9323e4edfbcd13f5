// Makes the exchange between patches fair: what a gives b is what b gives a, and each gets from all together what it
// sees of them. Points are not areas: beside an edge the middle of a patch gets less than its mean, and in a closed room
// of albedo .95 four percent of the light would be lost. The scale of rows and columns is found by turns
// (Sinkhorn 1967). Rays then know better what those see whose partners hide from each other, as parts of furniture do: the
// rest comes to them as what they get does. LPV_STEP 0: what each gets, a thread per patch; 1: means of both ways, a thread
// per eight partners; 2: one turn of scaling, a thread per patch; 3: by how much more comes, a thread per patch.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/patches.glsl"

#ifndef LPV_STEP
#error "LPV_STEP: 0 to 3"
#endif

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchExchange) buffer Exchange { float exchange[]; };

const float kMostScale = 2.0;  // of a row: few patches that hardly see each other say little
const float kMostGain = 4.0;   // the same of what rays see

#if LPV_STEP == 1
void main() {
  const int eights = (params.count + 7) / 8, index = params.first + int(gl_GlobalInvocationID.x);
  const int a = index / eights, begin = 8 * (index % eights);
  if (a >= params.count || begin + 7 <= a) return;
  for (int b = max(begin, a + 1); b < min(begin + 8, params.count); ++b) {
    const int there = a * params.stride + b, back = b * params.stride + a;
    const float mean = 0.5 * (exchange[there] + exchange[back]);
    exchange[there] = mean;
    exchange[back] = mean;
  }
}
#else
/// What all patches send to one, each times its scale.
float sumTo(int a, int scale) {
  float sum = 0.0;
  for (int b = 0; b < params.count; ++b)
    sum += exchange[b * params.stride + a] * (LPV_STEP == 0 ? 1.0 : patches[b].scale[scale]);
  return sum;
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x), before = 1 - (params.bounce & 1), now = 1 - before;
  if (a >= params.count) return;
#if LPV_STEP == 0
  patches[a].wanted = min(sumTo(a, before), kPi * patches[a].place.w);
  patches[a].scale[now] = 1.0;
#elif LPV_STEP == 2
  const float scale = patches[a].scale[before], sum = sumTo(a, before);
  const float next = sum > 0.0 ? sqrt(scale * patches[a].wanted / sum) : 1.0;
  patches[a].scale[now] = clamp(next, 1.0 / kMostScale, kMostScale);
#else
  const float scale = patches[a].scale[before], own = scale * scale * exchange[a * params.stride + a];
  const float others = scale * sumTo(a, before) - own;
  const float all = max(kPi * patches[a].place.w - own, 0.0);  // that others can be: it sees no more than its half space
  patches[a].of = others > 0.0 ? min(clamp((patches[a].of - own) / others, 1.0, kMostGain), all / others) : 1.0;
#endif
}
#endif
