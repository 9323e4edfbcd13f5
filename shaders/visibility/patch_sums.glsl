// What patches send to the points of a list, summed from batch to batch: patch_light.comp, which asks all patches anyway,
// finds it, and shadow_rays.comp chooses patches by it, each exactly as often as its light is worth. Of points of lights
// only some are weighed for each choice; patches differ too much for that: what arrives of few bright ones and what they
// send depended on the same luck, and the share of both was 14 % too high in a living room.
#include "visibility/patch_weight.glsl"

layout(std430, binding = kPatchSums) buffer PatchSums { float patchSums[]; };

/// Of what a patch of an area sends, what rays to it are to know: not what has been asked by itself already, or its pieces have.
float shareToAsk(float r2, float area, float from) { return r2 < kAskedPatch * area ? 0.0 : 1.0 - foldedShare(r2, from); }

int batchOf(int patchIndex) { return patchIndex / shadow.patchBatch; }

float patchSum(uint point, int batch) { return patchSums[point * uint(kPatchSumsOfPoint) + uint(batch)]; }

/// All patches up to the end of the batch, or up to where it is known.
void keepPatchSum(uint point, int batch, float sum) { patchSums[point * uint(kPatchSumsOfPoint) + uint(batch)] = sum; }
