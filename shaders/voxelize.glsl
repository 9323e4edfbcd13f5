// Voxelization of a light's triangles (paper 3.1; MATHS.md 2), whichever way its columns are walked: what one triangle
// adds to every cell it meets.
#include "layout.h"

layout(std140, binding = kParams) uniform Block { VoxelizeParams params; };
layout(binding = kPositions) uniform samplerBuffer positions;
layout(binding = kTriangles) uniform usamplerBuffer triangles;

#include "normal_bins.glsl"
#define LPV_DEPOSIT
#include "deposit.glsl"
#include "pairs.glsl"
#include "clip.glsl"
#if LPV_TEXTURED
#include "texture_integral.glsl"
#endif
#include "varying.glsl"
#if LPV_FLUX
#include "flux.glsl"
#else
#include "lobes.glsl"
#endif

/// A triangle of the light, in grid space.
struct EmittingTriangle {
  uint index;
  uvec3 corners;       // vertices
  LatticeTriangle lattice;
  dvec3 a, b, c;       // corners on the lattice
  double area;         // as a share of what the light's scale was made for
#if LPV_VPLS
  vec3 p, q, r;        // corners as they are
#endif
  Varying varying_;
};

dvec3 objectVertex(uint vertex) { return dvec3(texelFetch(positions, int(vertex)).xyz); }

dvec3 gridPoint(dvec3 p) {
  precise dvec3 g = params.gridFromObject[0].xyz * p.x + params.gridFromObject[1].xyz * p.y +
                    params.gridFromObject[2].xyz * p.z + params.gridFromObject[3].xyz;
  return g;
}

double longest(dvec3 v) { return max(abs(v.x), max(abs(v.y), abs(v.z))); }

/// False when the triangle emits nothing anywhere. Area and normal are the unsnapped triangle's: snapping decides pairs
/// and shares only.
bool loadTriangle(uint index, out EmittingTriangle e) {
  e.corners = texelFetch(triangles, int(index)).xyz;
  const dvec3 p = objectVertex(e.corners.x), q = objectVertex(e.corners.y), r = objectVertex(e.corners.z);
  precise dvec3 twiceArea = cross(q - p, r - p);
  if (twiceArea == dvec3(0.0lf)) return false;
  const dvec3 areaNormal = params.areaFromObject[0].xyz * twiceArea.x + params.areaFromObject[1].xyz * twiceArea.y +
                           params.areaFromObject[2].xyz * twiceArea.z;
  // Scaled first: the squares of a tiny triangle's normal would not fit.
  const double size = longest(areaNormal);
  if (!(size > 0.0lf)) return false;
  const dvec3 direction = areaNormal / size;
  const double length_ = sqrt(dot(direction, direction));
  e.index = index;
  e.area = length_ * size;
  e.varying_ = varyingOf(e.corners, vec3(direction / length_));
  const dvec3 gridP = gridPoint(p), gridQ = gridPoint(q), gridR = gridPoint(r);
  e.a = snapToLattice(gridP);
  e.b = snapToLattice(gridQ);
  e.c = snapToLattice(gridR);
#if LPV_VPLS
  e.p = vec3(gridP);
  e.q = vec3(gridQ);
  e.r = vec3(gridR);
#endif
  e.lattice = latticeTriangle(e.a, e.b, e.c, params.dims.xyz);
  return true;
}

#ifdef LPV_RECORD_PAIRS
void record(EmittingTriangle e, ivec3 cell) {
  recorded[atomicAdd(recordedCount, 1u)] =
      uvec2(e.index, (cell.z * params.dims.y + cell.y) * params.dims.x + cell.x);
}
#endif

/// Whether a triangle inside one cell can be taken as a whole. Only COUNT looks at where in its column a part lies.
const bool kWholeTriangles = LPV_FLUX == 1 || (LPV_DIRECTIONS == 0 && LPV_TEXTURED == 0);

#if LPV_VPLS
/// `lambda`: the part's centroid, barycentric.
void depositVpl(EmittingTriangle e, ivec3 cell, dvec2 lambda, Flux flux) {
  const vec2 at = vec2(lambda);
  const vec3 middle = e.p + at.x * (e.q - e.p) + at.y * (e.r - e.p);
  addVpl(cell, e.area * flux.share, clamp(middle - vec3(cell), 0.0, 1.0), meanDirection(flux), flux.colour);
}
#endif

/// The whole triangle into one cell.
void depositWhole(EmittingTriangle e, ivec3 cell) {
#ifdef LPV_RECORD_PAIRS
  record(e, cell);
#elif LPV_FLUX
  const Flux flux = fluxOf(e.varying_, wholeTriangle(), 1.0lf);
#if LPV_VPLS
  depositVpl(e, cell, dvec2(1.0lf / 3.0lf), flux);
#else
  addMoments(cell, e.area, flux.direction, flux.colour);
#endif
#else
  const Lobes lobes = lobesAtPoint(e.varying_, dvec2(1.0lf / 3.0lf));
  addLobes(cell, lobes.count, lobes.directions, lobes.colour);
#endif
}

#if !defined(LPV_RECORD_PAIRS) && LPV_FLUX
void depositPart(EmittingTriangle e, ivec3 cell) {
  const Boundary part = boundaryWithin(e.lattice, cell, false);
  const double share = enclosedShare(part, e.lattice);
#if LPV_DIRECTIONS || LPV_TEXTURED
  const Flux flux = fluxOf(e.varying_, barycentricBoundary(e.lattice, cell, part), share);
#else
  const Flux flux = Flux(share, sameForAll(dvec3(e.varying_.normal)), dvec3(1.0lf));
#endif
  const ivec3 position = turnedBack(cell, e.lattice.axis);
#if LPV_VPLS
  const dvec2 centre = (dvec2(cell.xy) + 0.5lf) * double(kLatticeUnits);
  depositVpl(e, position, clamp(barycentric(e.lattice, centre, centroidOf(part)), 0.0lf, 1.0lf), flux);
#else
  addMoments(position, e.area * flux.share, flux.direction, flux.colour);
#endif
}
#endif

/// The pairs of one column.
void voxelizeColumn(EmittingTriangle e, ivec2 column) {
  if (!meetsColumn(e.lattice, column)) return;
  const ivec2 depth = depthRange(e.lattice, column);
#if !defined(LPV_RECORD_PAIRS) && !LPV_FLUX
  const Lobes lobes = lobesOfColumn(e.varying_, e.lattice, column);
#endif
  for (int z = depth.x; z <= depth.y; ++z) {
    const ivec3 cell = ivec3(column, z);
    if (!meetsDepth(e.lattice, cell)) continue;
#ifdef LPV_RECORD_PAIRS
    record(e, turnedBack(cell, e.lattice.axis));
#elif LPV_FLUX
    depositPart(e, cell);
#else
    addLobes(turnedBack(cell, e.lattice.axis), lobes.count, lobes.directions, lobes.colour);
#endif
  }
}

/// Column number `index` of the triangle's box, row by row. Exact: there are at most 2^16, and half a column is far more
/// than the division's error.
ivec2 columnOf(LatticeTriangle t, int index) {
  const int across = t.upper.x - t.lower.x + 1;
  const int row = int((float(index) + 0.5) / float(across));
  return t.lower.xy + ivec2(index - row * across, row);
}
