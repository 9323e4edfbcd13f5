// Voxelization of light triangles (paper 3.1): a VPL, that is one clamped cosine lobe of the triangle's radiance, for
// every (triangle, cell) pair, added into fixed-point accumulators: order-independent, so the same bytes every run.
//
// LPV_SMALL: a thread per triangle; triangles over many columns are handed on as work items.
// LPV_LARGE: a work-group per work item, a thread per column.
#include "layout.h"
#include "sh.glsl"
#include "field.glsl"
#include "pairs.glsl"

#if !defined(LPV_SMALL) && !defined(LPV_LARGE)
#error "one of LPV_SMALL and LPV_LARGE"
#endif
#ifndef LPV_TWO_SIDED
#error "LPV_TWO_SIDED: 0 or 1"
#endif

#ifdef LPV_SMALL
layout(local_size_x = kVoxelizeGroup) in;
#else
layout(local_size_x = kColumnGroup) in;
#endif

layout(std140, binding = kParams) uniform Block { VoxelizeParams params; };
layout(std430, binding = kPositions) readonly buffer Positions { float positions[]; };
layout(std430, binding = kTriangles) readonly buffer Triangles { uint indices[]; };
layout(std430, binding = kCounters) buffer CounterBlock { Counters counters; };
layout(std430, binding = kLargeTriangles) buffer Large { uint largeHeader[kListHeaderWords]; uint large[]; };
#ifdef LPV_RECORD_PAIRS
layout(std430, binding = kRecordedPairs) buffer Recorded { uint recordedCount; uint recordedPad; uvec2 recorded[]; };
#else
layout(std430, binding = kAccumulators) buffer Accumulators { int words[]; };
layout(std430, binding = kTouchedCells) buffer Touched { uint touchedHeader[kListHeaderWords]; uint touched[]; };
#endif

/// What the triangle adds to every cell it meets.
struct Vpl {
  uint triangle;
  vec4 lobe;
};

#ifdef LPV_RECORD_PAIRS
void addVpl(Vpl vpl, ivec3 cell) {
  recorded[atomicAdd(recordedCount, 1u)] = uvec2(vpl.triangle, cellIndex(cell, params.dims.xyz));
}
#else
/// The first VPL of a cell appends it to the list, and every kCellGroup-th one adds a group to the next dispatch.
void touch(int cell) {
  const uint slot = atomicAdd(touchedHeader[3], 1u);
  touched[slot] = uint(cell);
  if (slot % uint(kCellGroup) == 0u) atomicAdd(touchedHeader[0], 1u);
}

void addVpl(Vpl vpl, ivec3 cellPosition) {
  const int cell = cellIndex(cellPosition, params.dims.xyz);
  const int base = cell * kAccumulatorWords;
  if (atomicAdd(words[base + kCountWord], LPV_TWO_SIDED + 1) == 0) touch(cell);
  for (int k = 0; k < LPV_CHANNELS; ++k) {
    if (params.weight[k] == 0.0) continue;  // uniform: a light of another chromaticity
    const ivec4 q = ivec4(roundEven(params.weight[k] * vpl.lobe));
#if LPV_TWO_SIDED
    atomicAdd(words[base + 4 * k], 2 * q.x);  // lobe(n) + lobe(-n): band 1 cancels
#else
    atomicAdd(words[base + 4 * k], q.x);
    atomicAdd(words[base + 4 * k + 1], q.y);
    atomicAdd(words[base + 4 * k + 2], q.z);
    atomicAdd(words[base + 4 * k + 3], q.w);
#endif
  }
}
#endif

dvec3 objectVertex(uint triangle, uint corner) {
  const uint v = indices[3u * triangle + corner] * 3u;
  return dvec3(positions[v], positions[v + 1u], positions[v + 2u]);
}

dvec3 gridPoint(dvec3 p) {
  precise dvec3 g = params.gridFromObject[0].xyz * p.x + params.gridFromObject[1].xyz * p.y +
                    params.gridFromObject[2].xyz * p.z + params.gridFromObject[3].xyz;
  return g;
}

/// The pairs of one column.
void voxelizeColumn(LatticeTriangle t, Vpl vpl, ivec2 column) {
  const ivec2 depth = depthRange(t, column);
  for (int z = depth.x; z <= depth.y; ++z) {
    if (isPair(t, ivec3(column, z))) addVpl(vpl, turnedBack(ivec3(column, z), t.axis));
  }
}

ivec2 columnOf(LatticeTriangle t, int index) {
  const int across = t.upper.x - t.lower.x + 1;
  return t.lower.xy + ivec2(index % across, index / across);
}

int slicesOf(int columns) { return min(kMaxSlices, (columns + kColumnGroup - 1) / kColumnGroup); }

#ifdef LPV_SMALL

void handOn(uint local, int columns) {
  const int slices = slicesOf(columns);
  const uint slot = atomicAdd(largeHeader[3], uint(slices));
  atomicAdd(largeHeader[0], uint(slices));
  for (int i = 0; i < slices; ++i) large[slot + uint(i)] = local * uint(kMaxSlices) + uint(i);
}

void voxelizeSmall(LatticeTriangle t, Vpl vpl, int columns) {
  if (t.oneCell) {  // nothing to test
    addVpl(vpl, turnedBack(t.lower, t.axis));
    return;
  }
  for (int i = 0; i < columns; ++i) voxelizeColumn(t, vpl, columnOf(t, i));
}

#endif

/// Both passes look at a triangle through this; false when it emits nothing anywhere.
bool loadTriangle(uint triangle, out dvec3 a, out dvec3 b, out dvec3 c, out Vpl vpl) {
  const dvec3 p = objectVertex(triangle, 0u), q = objectVertex(triangle, 1u), r = objectVertex(triangle, 2u);
  precise dvec3 areaNormal = cross(q - p, r - p);
  if (areaNormal == dvec3(0.0lf)) return false;
  const dvec3 outward = (params.outwardFromObject * dvec4(areaNormal, 0.0lf)).xyz;
  vpl.triangle = triangle;
  // Scaled first: the squares of a tiny triangle's normal would not fit a float.
  vpl.lobe = shLobe(normalize(vec3(outward / max(abs(outward.x), max(abs(outward.y), abs(outward.z))))));
  a = snapToLattice(gridPoint(p));
  b = snapToLattice(gridPoint(q));
  c = snapToLattice(gridPoint(r));
  return true;
}

void main() {
#ifdef LPV_SMALL
  const uint local = gl_GlobalInvocationID.x;
  if (local >= params.triangles.y) return;
#else
  const uint item = large[gl_WorkGroupID.x];
  const uint local = item / uint(kMaxSlices);
#endif
  dvec3 a, b, c;
  Vpl vpl;
  const bool emits = loadTriangle(params.triangles.x + local, a, b, c, vpl);
#ifdef LPV_SMALL
  if (!emits) {
    atomicAdd(counters.degenerate, 1u);
    return;
  }
#endif
  const LatticeTriangle t = latticeTriangle(a, b, c, params.dims.xyz);
  const int columns = columnCount(t);
#ifdef LPV_SMALL
  ivec3 cell;
  if (degenerate(t)) {
    if (centroidCell(a, b, c, params.dims.xyz, cell)) addVpl(vpl, cell);
  } else if (columns > kSmallColumns) {
    handOn(local, columns);
  } else if (columns > 0) {
    voxelizeSmall(t, vpl, columns);
  }
#else
  const int slice = int(item) % kMaxSlices;
  const int stride = slicesOf(columns) * kColumnGroup;
  for (int i = slice * kColumnGroup + int(gl_LocalInvocationID.x); i < columns; i += stride) {
    voxelizeColumn(t, vpl, columnOf(t, i));
  }
#endif
}
