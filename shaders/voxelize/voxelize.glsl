// Voxelization of a light's triangles (paper 3.1; MATHS.md 2), whichever way its columns are walked: what one triangle
// adds to every cell it meets.
#include "layout.h"

layout(std140, binding = kParams) uniform Block { VoxelizeParams params; };
layout(binding = kPositions) uniform samplerBuffer positions;
layout(binding = kTriangles) uniform usamplerBuffer triangles;

#include "voxelize/normal_bins.glsl"
#define LPV_DEPOSIT
#include "voxelize/deposit.glsl"
#include "voxelize/pairs.glsl"
// LPV_OUTLINED: what is asked of a part of a triangle takes its whole boundary.
#define LPV_OUTLINED (LPV_DIRECTIONS || LPV_TEXTURED || LPV_SQUARES)
#if LPV_OUTLINED
#include "voxelize/clip.glsl"
#endif
#if LPV_TEXTURED
#include "voxelize/texture_integral.glsl"
#endif
#include "voxelize/varying.glsl"
#if LPV_FLUX && !LPV_OUTLINED
#include "voxelize/share.glsl"
#endif
#if LPV_FLUX
#include "voxelize/flux.glsl"
#else
#include "voxelize/lobes.glsl"
#endif

#if LPV_VPLS && LPV_SQUARES
#define Point dvec3  // second moments take more digits
#define Square dmat3
#else
#define Point vec3
#define Square mat3
#endif

/// A triangle of the light, in grid space.
struct EmittingTriangle {
  uint index;
  uvec3 corners;       // vertices
  LatticeTriangle lattice;
  double area;         // as a share of what the light's scale was made for
#if LPV_VPLS
  Point p, q, r;       // corners as they are
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
#if LPV_VPLS
  e.p = Point(gridP);
  e.q = Point(gridQ);
  e.r = Point(gridR);
#endif
  e.lattice = latticeTriangle(snapToLattice(gridP), snapToLattice(gridQ), snapToLattice(gridR), params.dims);
  return true;
}

#ifdef LPV_RECORD_PAIRS
void record(EmittingTriangle e, ivec3 cell) {
  recorded[atomicAdd(recordedCount, 1u)] =
      uvec2(e.index, (cell.z * params.dims.y + cell.y) * params.dims.x + cell.x);
}
#endif

/// Whether a triangle can be taken as a whole: nothing to test, nothing to clip. Where in its column a part lies is what
/// COUNT asks of a varying one, unless it is a point to the grid.
bool isWhole(LatticeTriangle t) {
  return t.oneCell && (LPV_FLUX == 1 || (LPV_DIRECTIONS == 0 && LPV_TEXTURED == 0) || degenerate(t));
}

#if !defined(LPV_RECORD_PAIRS) && LPV_FLUX

#if LPV_VPLS
void depositFlux(EmittingTriangle e, ivec3 cell, Flux flux, Place place) {
  const Point at = Point(place.middle, 0.0), pq = e.q - e.p, pr = e.r - e.p;
  const Point offset = clamp(e.p + at.x * pq + at.y * pr - Point(cell), 0.0, 1.0);
  Square covariance = Square(0.0);
#if LPV_SQUARES
  const dvec3 c = place.covariance;
  covariance = outerProduct(pq, c.x * pq + c.z * pr) + outerProduct(pr, c.z * pq + c.y * pr);
#endif
  addVpl(cell, e.area * flux.share, dvec3(offset), dmat3(covariance), meanDirection(flux), flux.colour);
}
#else
void depositFlux(EmittingTriangle e, ivec3 cell, Flux flux, Place place) {
  addMoments(cell, e.area * flux.share, flux.direction, flux.colour);
}
#endif

#if LPV_OUTLINED
/// `share` of the triangle, bounded by `part` (barycentric).
void depositOutlined(EmittingTriangle e, ivec3 cell, Boundary part, double share) {
  Place place = placeOf(part);
  const Flux flux = fluxOf(e.varying_, part, share, place);
  depositFlux(e, cell, flux, place);
}
#endif

/// What lies in a (turned) cell.
void depositPart(EmittingTriangle e, ivec3 cell, bool whole) {
#if LPV_OUTLINED
  Boundary part = wholeTriangle();
  double share = 1.0lf;
  if (!whole) {
    part = boundaryWithin(e.lattice, cell, false);
    share = enclosedShare(part, e.lattice);
    part = barycentricBoundary(e.lattice, cell, part);
  }
  depositOutlined(e, turnedBack(cell, e.lattice.axis), part, share);
#else
  Place place = Place(dvec2(1.0lf / 3.0lf), dvec3(0.0lf));
  const double share = whole ? 1.0lf : shareWithin(e.lattice, cell, place.middle);
  depositFlux(e, turnedBack(cell, e.lattice.axis), evenFlux(e.varying_, share), place);
#endif
}
#endif

/// A walk through a triangle's pairs: in every `rowStep`-th row, every `step`-th of the columns that it meets from number
/// `first` on.
struct Walk {
  int first, step, rowStep;
  ivec3 cell;      // turned
  int lastColumn;  // of the cell's row
  int lastDepth;   // of its column
};

/// Goes on to the next pair; false when there is none. What is done to a pair costs more than finding it: threads that
/// run in step wait for each other here, and then all of them have one.
bool nextPair(LatticeTriangle t, CellTests tests, bool whole, inout Walk walk) {
  bool found = false;
  while (!found && (walk.cell.z < walk.lastDepth || walk.cell.x + walk.step <= walk.lastColumn ||
                    walk.cell.y + walk.rowStep <= t.upper.y)) {
    if (walk.cell.z < walk.lastDepth) {
      ++walk.cell.z;
    } else {
      walk.cell.x += walk.step;
      if (walk.cell.x > walk.lastColumn) {
        walk.cell.y += walk.rowStep;
        const ivec2 columns = whole ? ivec2(t.lower.x) : columnsInRow(t, tests, walk.cell.y);
        walk.cell.x = columns.x + walk.first;
        walk.lastColumn = columns.y;
      }
      const ivec2 depths = whole ? ivec2(t.lower.z) : depthsInColumn(t, tests, walk.cell.xy);
      walk.cell.z = depths.x;
      walk.lastDepth = walk.cell.x <= walk.lastColumn ? depths.y : depths.x - 1;
    }
    found = walk.cell.z <= walk.lastDepth;
  }
  return found;
}

void depositPair(EmittingTriangle e, ivec3 cell, bool whole) {
#ifdef LPV_RECORD_PAIRS
  record(e, turnedBack(cell, e.lattice.axis));
#elif LPV_FLUX
  depositPart(e, cell, whole);
#elif LPV_SETS
  addToSet(turnedBack(cell, e.lattice.axis), e.index);
#else
  Lobes lobes;
  if (whole) lobes = lobesAtPoint(e.varying_, dvec2(1.0lf / 3.0lf));
  else lobes = lobesOfColumn(e.varying_, e.lattice, cell.xy);
  addLobes(turnedBack(cell, e.lattice.axis), lobes.count, lobes.directions, lobes.colour);
#endif
}

void voxelizeAlong(EmittingTriangle e, Walk walk) {
  const bool whole = isWhole(e.lattice);
  const CellTests tests = cellTests(e.lattice);
  while (nextPair(e.lattice, tests, whole, walk)) depositPair(e, walk.cell, whole);
}

/// The pairs of every `rowStep`-th row of columns from number `row` on, and of them every `step`-th column from number
/// `first` on.
void voxelizeRows(EmittingTriangle e, int row, int rowStep, int first, int step_) {
  voxelizeAlong(e, Walk(first, step_, rowStep, ivec3(0, e.lattice.lower.y + row - rowStep, 0), -1, -1));
}

/// The pairs of one column of the triangle's box.
void voxelizeColumn(EmittingTriangle e, ivec2 column) {
  voxelizeAlong(e, Walk(0, 1, e.lattice.dims.y, ivec3(column.x - 1, column.y, 0), column.x, -1));
}
