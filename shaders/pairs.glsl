// The exact set of (triangle, cell) pairs of one triangle (paper 3.1; MATHS.md 2): vertices snapped to 1/256 cell,
// strict overlap on the 13 axes of the triangle/box test (Akenine-Moller 2001) evaluated in double on integers, so that
// no rounding happens (|coordinate| < 2^17 lattice units: products below 2^53).

/// A triangle on the lattice, turned so that its dominant axis is the third: columns run along it.
struct LatticeTriangle {
  dvec3 v0, v1, v2;   // lattice units; exact integers
  dvec3 normal;       // cross product of edges, exact; zero when degenerate
  dvec2 slope;        // how much less depth per step across
  dvec3 reach[3];     // of the edges from v0, v1, v2: see overlaps()
  ivec3 dims;         // of the grid, turned the same way
  int axis;           // which axis is dominant: 0 x, 1 y, 2 z
  ivec3 lower, upper; // candidate cells, both inclusive; empty where lower > upper
  bool oneLayer;      // all candidate cells have one depth
  bool oneCell;       // wholly inside one cell, in the grid or not; a degenerate one: in its centroid's
};

double cross2(dvec2 p, dvec2 q) { return p.x * q.y - p.y * q.x; }

dvec3 snapToLattice(dvec3 gridPoint) { return floor(gridPoint * double(kLatticeUnits) + 0.5lf); }

dvec3 turned(dvec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
ivec3 turned(ivec3 v, int axis) { return axis == 0 ? v.yzx : axis == 1 ? v.zxy : v; }
ivec3 turnedBack(ivec3 v, int axis) { return axis == 0 ? v.zxy : axis == 1 ? v.yzx : v; }

/// First and last cell, `units` wide, that [least, most] of one axis can make a pair with, up to one beyond the grid. An
/// interval of no length on a cell face belongs to the upper cell, or to the last cell of the grid.
ivec2 cellRange(double least, double most, double units, int cells) {
  // Clamped before the conversion: a far vertex must not wrap around in int.
  double first = clamp(floor(least / units), -1.0lf, double(cells));
  double last = clamp(ceil(most / units) - 1.0lf, -1.0lf, double(cells));
  if (least == most) {
    if (least == units * double(cells)) first = double(cells) - 1.0lf;
    last = first;
  }
  return ivec2(int(first), int(last));
}

bool degenerate(LatticeTriangle t) { return t.normal == dvec3(0.0lf); }

/// How far apart a cell and the triangle may be on the three axes of an edge, edge x (each direction of the grid), in the
/// measure of overlaps().
dvec3 reachOf(dvec3 edge, dvec3 normal) {
  const dvec3 e = abs(edge);
  return max(double(kLatticeUnits) * (e.yzx + e.zxy), dvec3(1.0lf)) + abs(normal);
}

LatticeTriangle latticeTriangle(dvec3 a, dvec3 b, dvec3 c, ivec3 dims) {
  LatticeTriangle t;
  precise dvec3 normal = cross(b - a, c - a);
  const dvec3 size = abs(normal);
  t.axis = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
  t.v0 = turned(a, t.axis);
  t.v1 = turned(b, t.axis);
  t.v2 = turned(c, t.axis);
  t.normal = turned(normal, t.axis);
  t.slope = t.normal.xy / t.normal.z;
  t.reach[0] = reachOf(t.v1 - t.v0, t.normal);
  t.reach[1] = reachOf(t.v2 - t.v1, t.normal);
  t.reach[2] = reachOf(t.v0 - t.v2, t.normal);
  t.dims = turned(dims, t.axis);
  dvec3 least = min(t.v0, min(t.v1, t.v2));
  dvec3 most = max(t.v0, max(t.v1, t.v2));
  double units = double(kLatticeUnits);
  if (degenerate(t)) {  // all of it where its centroid is
    least = most = t.v0 + t.v1 + t.v2;
    units *= 3.0lf;
  }
  for (int k = 0; k < 3; ++k) {
    const ivec2 range = cellRange(least[k], most[k], units, t.dims[k]);
    t.lower[k] = range.x;
    t.upper[k] = range.y;
  }
  t.oneLayer = t.lower.z == t.upper.z;
  t.oneCell = t.lower == t.upper;
  t.lower = max(t.lower, ivec3(0));
  t.upper = min(t.upper, t.dims - 1);
  return t;
}

/// Columns of the triangle's box within the grid; 0 where there are none.
int columnCount(LatticeTriangle t) {
  const ivec2 n = t.upper.xy - t.lower.xy + 1;
  return t.upper.z < t.lower.z ? 0 : max(n.x, 0) * max(n.y, 0);
}

/// Cells of one column to be tested: 1.001 around the plane's depth at the column's centre (MATHS.md 2).
ivec2 depthRange(LatticeTriangle t, ivec2 column) {
  if (t.lower.z == t.upper.z) return ivec2(t.lower.z);
  const dvec2 centre = (dvec2(column) + 0.5lf) * double(kLatticeUnits);
  const double depth = (t.v0.z - dot(t.slope, centre - t.v0.xy)) / double(kLatticeUnits);
  const double first = clamp(floor(depth - 1.001lf), -1.0lf, double(t.dims.z));
  const double last = clamp(floor(depth + 1.001lf), -1.0lf, double(t.dims.z));
  return ivec2(max(t.lower.z, int(first)), min(t.upper.z, int(last)));
}

/// Strict overlap of [at, at + across] with [-h, h], h half a cell's extent along the axis: where the intervals' centres
/// are nearer than half their lengths. All doubled, so that nothing is halved: 2 h + |across| is the reach; with h = 0,
/// an axis that says nothing, it is one more than that, which every integer is nearer than.
bool overlaps(double at, double across, double reach) { return abs(2.0lf * at + across) < reach; }

/// One axis across the column, edge x (direction of the column). Both ends of the edge, `p` among them, project to the
/// same place, and the third corner as far from it as the normal is long on that axis.
bool overlapsBeside(LatticeTriangle t, dvec2 p, dvec2 e, double reach) {
  precise const double end = e.x * p.y - e.y * p.x;
  return overlaps(end, t.normal.z, reach);
}

/// The axes that see no depth: all that tells apart the columns of the triangle's box.
bool meetsColumn(LatticeTriangle t, ivec2 column) {
  const dvec2 centre = (dvec2(column) + 0.5lf) * double(kLatticeUnits);
  return overlapsBeside(t, t.v0.xy - centre, t.v1.xy - t.v0.xy, t.reach[0].z) &&
         overlapsBeside(t, t.v1.xy - centre, t.v2.xy - t.v1.xy, t.reach[1].z) &&
         overlapsBeside(t, t.v2.xy - centre, t.v0.xy - t.v2.xy, t.reach[2].z);
}

/// The two other axes of one edge, edge x (the unit vectors across the column).
bool overlapsAcross(LatticeTriangle t, dvec3 p, dvec3 e, dvec3 reach) {
  precise const double x = e.y * p.z - e.z * p.y, y = e.z * p.x - e.x * p.z;
  return overlaps(x, t.normal.x, reach.x) && overlaps(y, t.normal.y, reach.y);
}

/// The axes that see depth, for a cell of a column that the triangle meets. In one layer, or in a face plane, there is
/// nothing left to ask.
bool meetsDepth(LatticeTriangle t, ivec3 cell) {
  if (t.oneLayer) return true;
  const double halfCell = 0.5lf * double(kLatticeUnits);
  const dvec3 centre = (dvec3(cell) + 0.5lf) * double(kLatticeUnits);
  const dvec3 a = t.v0 - centre, b = t.v1 - centre, c = t.v2 - centre;
  precise const double depth = dot(t.normal, a);
  return abs(depth) < halfCell * (abs(t.normal.x) + abs(t.normal.y) + abs(t.normal.z)) &&
         overlapsAcross(t, a, t.v1 - t.v0, t.reach[0]) && overlapsAcross(t, b, t.v2 - t.v1, t.reach[1]) &&
         overlapsAcross(t, c, t.v0 - t.v2, t.reach[2]);
}
