// Voxelization of triangles that snapping makes a segment over several cells (voxelize/thin.glsl), for every injector: a
// work-group per segment, a thread for every kThinGroup-th layer of cells along it.
#include "voxelize/voxelize.glsl"
#include "voxelize/thin.glsl"
#include "voxelize/thin_list.glsl"

layout(local_size_x = kThinGroup) in;

#if defined(LPV_RECORD_PAIRS)
void depositStrip(EmittingTriangle e, ivec3 cell, Strip strip) { record(e, cell); }
#elif LPV_FLUX
void depositStrip(EmittingTriangle e, ivec3 cell, Strip strip) {
  Place place;
  const double share = shareOf(strip, place.middle);
#if LPV_OUTLINED
  Boundary part = noBoundary();
  for (int i = 0; i < kStripPieces; ++i) addPiece(i, strip.pieces[i], part);
  depositOutlined(e, cell, part, share);
#else
  place.covariance = dvec3(0.0lf);
  depositFlux(e, cell, evenFlux(e.varying_, share), place);
#endif
}
#elif LPV_SETS
void depositStrip(EmittingTriangle e, ivec3 cell, Strip strip) { addToSet(cell, e.index); }
#else
void depositStrip(EmittingTriangle e, ivec3 cell, Strip strip) {
  dvec2 lambda;
  shareOf(strip, lambda);
  const Lobes lobes = lobesAtPoint(e.varying_, lambda);
  addLobes(cell, lobes.count, lobes.directions, lobes.colour);
}
#endif

bool inGrid(ivec2 cell, ivec3 dims) {
  return all(greaterThanEqual(cell, ivec2(0))) && all(lessThan(cell, dims.xy));
}

void main() {
  EmittingTriangle e;
  if (!loadTriangle(thin[gl_WorkGroupID.x], e)) return;
  const Segment s = segmentOf(e.lattice);
  const ivec2 layers = cellRange(s.from.z, s.to.z, double(kLatticeUnits), s.dims.z);
  const int last = min(layers.y, s.dims.z - 1);
  for (int layer = max(layers.x, 0) + int(gl_LocalInvocationID.x); layer <= last; layer += kThinGroup) {
    const Passage p = passageOf(s, layer);
    for (int i = 0; i < p.count; ++i) {
      if (!inGrid(p.cells[i], s.dims)) continue;
      depositStrip(e, turnedBack(ivec3(p.cells[i], layer), s.axis), stripOf(s.places, p.cuts[i], p.cuts[i + 1]));
    }
  }
}
