// Voxelization in compute.
//
// LPV_SMALL: a thread per triangle; triangles over many columns are handed on as work items.
// LPV_LARGE: a work-group per work item, a thread per column.
#include "voxelize.glsl"

#if !defined(LPV_SMALL) && !defined(LPV_LARGE)
#error "one of LPV_SMALL and LPV_LARGE"
#endif

#ifdef LPV_SMALL
layout(local_size_x = kVoxelizeGroup) in;
#else
layout(local_size_x = kColumnGroup) in;
#endif

layout(std430, binding = kLargeTriangles) buffer Large { uint largeHeader[kListHeaderWords]; uint large[]; };

const bool kVarying = LPV_DIRECTIONS == 1 || LPV_TEXTURED == 1;
const int kUnsplitColumns = kVarying ? kSmallVaryingColumns : kSmallColumns;
const int kSlices = kVarying ? kMaxVaryingSlices : kMaxSlices;
const int kSliceColumns = kColumnGroup * (kVarying ? 1 : kColumnsPerThread);

int slicesOf(int columns) { return min(kSlices, (columns + kSliceColumns - 1) / kSliceColumns); }

#ifdef LPV_SMALL

void handOn(uint local, int columns) {
  const int slices = slicesOf(columns);
  const uint slot = atomicAdd(largeHeader[3], uint(slices));
  atomicAdd(largeHeader[0], uint(slices));
  for (int i = 0; i < slices; ++i) large[slot + uint(i)] = local * uint(kSlices) + uint(i);
}

void main() {
  const uint local = gl_GlobalInvocationID.x;
  if (local >= params.triangles.y) return;
  EmittingTriangle e;
  if (!loadTriangle(params.triangles.x + local, e)) {
    atomicAdd(voxelHeader[4], 1u);
    return;
  }
  const int columns = columnCount(e.lattice);
  if (columns > kUnsplitColumns || (columns > 1 && laborious(e.varying_))) handOn(local, columns);
  else voxelizeColumns(e, 0, 1, columns);
}

#else

void main() {
  const uint item = large[gl_WorkGroupID.x];
  EmittingTriangle e;
  if (!loadTriangle(params.triangles.x + item / uint(kSlices), e)) return;
  const int columns = columnCount(e.lattice);
  const int slice = int(item) % kSlices;
  voxelizeColumns(e, slice * kColumnGroup + int(gl_LocalInvocationID.x), slicesOf(columns) * kColumnGroup, columns);
}

#endif
