// Where a light's voxels are summed: integers only, so that the sums do not depend on the order of the additions and are
// the same bits on every run and from every voxelizer.
//
// Words of a cell: shaders/layout.h. LPV_TEXTURED: moments of each colour. LPV_SETS: COUNT of a light with at most
// kSetTriangles triangles keeps which of them came, and no sums.
// LPV_VPLS: FLUX for GATHER has a table of VPLs instead, shaders/voxelize/vpl_table.glsl.
#ifndef LPV_FLUX
#error "LPV_FLUX: 0 (COUNT) or 1"
#endif
#ifndef LPV_TEXTURED
#error "LPV_TEXTURED: 0 or 1"
#endif

#ifndef LPV_VPLS
#define LPV_VPLS 0
#endif

#if !LPV_VPLS
#define LPV_SQUARES 0
#endif

#ifndef LPV_SETS
#define LPV_SETS 0
#endif

#if LPV_TEXTURED
const int kMomentsPerCell = kColours;
#else
const int kMomentsPerCell = 1;
#endif
#if LPV_FLUX && LPV_TEXTURED
const int kAccumulatorWords = kTexturedFluxWords;
#elif LPV_FLUX
const int kAccumulatorWords = kFluxWords;
#elif LPV_SETS
const int kAccumulatorWords = kSetWords;
#elif LPV_TEXTURED
const int kAccumulatorWords = kTexturedCountWords;
#else
const int kAccumulatorWords = kCountWords;
#endif

#include "voxelize/voxel_list.glsl"
#if LPV_VPLS
#include "voxelize/vpl_table.glsl"
#else
#ifdef LPV_RECORD_PAIRS
layout(std430, binding = kRecordedPairs) buffer Recorded { uint recordedCount; uint recordedPad; uvec2 recorded[]; };
#else
layout(std430, binding = kAccumulators) buffer Accumulators { uint words[]; };
#endif
#endif
