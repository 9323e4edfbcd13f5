// Voxelization in compute.
//
// LPV_SMALL: a thread per triangle; triangles over many columns are handed on as work items, segments to thin.comp.
// LPV_LARGE: a work-group per work item, a thread for a row of columns or every n-th column of one.
#include "voxelize/voxelize.glsl"

#if !defined(LPV_SMALL) && !defined(LPV_LARGE)
#error "one of LPV_SMALL and LPV_LARGE"
#endif

#ifdef LPV_SMALL
#include "voxelize/thin_list.glsl"
layout(local_size_x = kVoxelizeGroup) in;
#else
layout(local_size_x = kColumnGroup) in;
#endif

layout(std430, binding = kLargeTriangles) buffer Large { ListHeader largeHeader; uint large[]; };

const bool kVarying = LPV_DIRECTIONS == 1 || LPV_TEXTURED == 1;
const int kSlices = kVarying ? kMaxVaryingSlices : kMaxSlices;
const int kThreadColumns = kVarying ? 1 : kColumnsPerThread;

/// How a triangle's columns are shared out: work items, and threads for each row of columns.
struct Shares {
  int slices, perRow;
};

Shares sharesOf(LatticeTriangle t, int columns) {
  const int width = t.upper.x - t.lower.x + 1, rows = t.upper.y - t.lower.y + 1;
  const int perRow = clamp(min(columns / kThreadColumns, kSlices * kColumnGroup) / rows, 1, width);
  return Shares(min(kSlices, (rows * perRow + kColumnGroup - 1) / kColumnGroup), perRow);
}

#ifdef LPV_SMALL

void handOn(uint local, int slices) {
  const uint slot = atomicAdd(largeHeader.count, uint(slices));
  atomicAdd(largeHeader.groupsX, uint(slices));
  for (int i = 0; i < slices; ++i) large[slot + uint(i)] = local * uint(kSlices) + uint(i);
}

void main() {
  const uint local = gl_GlobalInvocationID.x;
  if (local >= params.triangleCount) return;
  EmittingTriangle e;
  if (!loadTriangle(params.firstTriangle + local, e)) {
    atomicAdd(voxelHeader.degenerate, 1u);
    return;
  }
  const int columns = columnCount(e.lattice);
  if (isThin(e.lattice)) {
    if (columns > 0) handOnThin(e.index);
    return;
  }
  const int most = kVarying ? kSmallVaryingColumns : params.triangleCount < kManyTriangles ? kSmallColumns : kManyColumns;
  if (columns > most || (columns > 1 && laborious(e.varying_))) handOn(local, sharesOf(e.lattice, columns).slices);
  else if (columns > 0) voxelizeRows(e, 0, 1, 0, 1);
}

#else

void main() {
  const uint item = large[gl_WorkGroupID.x];
  EmittingTriangle e;
  if (!loadTriangle(params.firstTriangle + item / uint(kSlices), e)) return;
  const Shares shares = sharesOf(e.lattice, columnCount(e.lattice));
  const int thread = int(item) % kSlices * kColumnGroup + int(gl_LocalInvocationID.x);
  const int rowStep = shares.slices * kColumnGroup / shares.perRow, row = thread / shares.perRow;
  if (row < rowStep) voxelizeRows(e, row, rowStep, thread % shares.perRow, shares.perRow);
}

#endif
