// The exact set of (triangle, cell) pairs of one triangle (paper 3.1; MATHS.md 2): vertices snapped to 1/256 cell,
// strict overlap on the 13 axes of the triangle/box test (Akenine-Moller 2001) evaluated in double on integers, so that
// no rounding happens (|coordinate| < 2^17 lattice units: products below 2^53). One that snapping makes a segment over
// several cells has no plane to ask about: voxelize/thin.glsl.

/// A triangle on the lattice, turned so that its dominant axis is the third: columns run along it.
struct LatticeTriangle {
  dvec3 v0, v1, v2;   // lattice units; exact integers
  dvec3 normal;       // cross product of edges, exact; zero when degenerate
  ivec3 dims;         // of the grid, turned the same way
  int axis;           // which axis is dominant: 0 x, 1 y, 2 z
  ivec3 lower, upper; // candidate cells, both inclusive; empty where lower > upper
  bool oneLayer;      // all candidate cells have one depth
  bool oneCell;       // wholly inside one cell, in the grid or not
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

/// A segment over several cells, not for columns.
bool isThin(LatticeTriangle t) { return degenerate(t) && !t.oneCell; }

LatticeTriangle latticeTriangle(dvec3 a, dvec3 b, dvec3 c, ivec3 dims) {
  LatticeTriangle t;
  precise dvec3 normal = cross(b - a, c - a);
  const dvec3 size = abs(normal);
  t.axis = size.z >= size.x && size.z >= size.y ? 2 : size.y >= size.x ? 1 : 0;
  t.v0 = turned(a, t.axis);
  t.v1 = turned(b, t.axis);
  t.v2 = turned(c, t.axis);
  t.normal = turned(normal, t.axis);
  t.dims = turned(dims, t.axis);
  const dvec3 least = min(t.v0, min(t.v1, t.v2));
  const dvec3 most = max(t.v0, max(t.v1, t.v2));
  const double cell = double(kLatticeUnits);
  const ivec2 x = cellRange(least.x, most.x, cell, t.dims.x), y = cellRange(least.y, most.y, cell, t.dims.y),
              z = cellRange(least.z, most.z, cell, t.dims.z);
  t.lower = ivec3(x.x, y.x, z.x);
  t.upper = ivec3(x.y, y.y, z.y);
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

/// What the 10 axes that are left after the boxes ask of a cell: the normal, and each edge x each direction of the grid.
/// All are linear in the cell's place, so each is the number at cell (0, 0, 0) and a step along each axis, exact integers
/// again. An edge's axes come three at a time: one number per edge.
struct CellTests {
  dvec3 ex, ey, ez;                // steps: the edges' components x 2 cells
  dvec3 besideX, besideY, besideZ; // axis edge x (direction) at cell (0, 0, 0), doubled, with the third corner's end
  dvec3 reachX, reachY, reachZ;    // overlap where nearer to 0 than this
  dvec3 planeStep;
  double plane, planeReach;        // the same for the normal, not doubled
  double perDepth;                 // 1 / planeStep.z
  dvec3 perColumn, columnReach;    // 1 / ey, 0 where that is 0; reachZ in columns and a little more
};

/// How far apart a cell and the triangle may be on the axis edge x (direction), for three edges whose components across
/// the direction are given: strict overlap of [at, at + across] with [-h, h], h half a cell's extent along the axis, is
/// where the intervals' centres are nearer than half their lengths. All doubled, so that nothing is halved:
/// 2 h + |across|; with h = 0, an axis that says nothing, one more than that, which every integer is nearer than.
dvec3 reachOf(dvec3 steps, dvec3 moreSteps, double across) {
  return max(0.5lf * (abs(steps) + abs(moreSteps)), dvec3(1.0lf)) + abs(across);
}

/// Columns that columnsInRow() is too generous by: more than rounding, and more columns than a grid has.
const double kColumnMargin = 0.0009765625lf;
const int kBeyondColumns = 1 << 20;

CellTests cellTests(LatticeTriangle t) {
  const double cell = double(kLatticeUnits);
  const dvec3 a = t.v0 - 0.5lf * cell, b = t.v1 - 0.5lf * cell, c = t.v2 - 0.5lf * cell;
  const dvec3 px = dvec3(a.x, b.x, c.x), py = dvec3(a.y, b.y, c.y), pz = dvec3(a.z, b.z, c.z);
  CellTests s;
  s.ex = 2.0lf * cell * (px.yzx - px);
  s.ey = 2.0lf * cell * (py.yzx - py);
  s.ez = 2.0lf * cell * (pz.yzx - pz);
  // Both ends of an edge project to the same place, and the third corner as far from it as the normal is long there.
  precise const dvec3 x = (s.ey * pz - s.ez * py) / cell + t.normal.x, y = (s.ez * px - s.ex * pz) / cell + t.normal.y,
                      z = (s.ex * py - s.ey * px) / cell + t.normal.z;
  s.besideX = x;
  s.besideY = y;
  s.besideZ = z;
  s.reachX = reachOf(s.ey, s.ez, t.normal.x);
  s.reachY = reachOf(s.ez, s.ex, t.normal.y);
  s.reachZ = reachOf(s.ex, s.ey, t.normal.z);
  precise const double plane = dot(t.normal, a);
  s.plane = plane;
  s.planeStep = -cell * t.normal;
  s.planeReach = 0.5lf * cell * (abs(t.normal.x) + abs(t.normal.y) + abs(t.normal.z));
  s.perDepth = 1.0lf / s.planeStep.z;
  const bvec3 across = notEqual(s.ey, dvec3(0.0lf));
  s.perColumn = mix(dvec3(0.0lf), 1.0lf / s.ey, across);
  s.columnReach = mix(dvec3(double(kBeyondColumns)), s.reachZ * abs(s.perColumn) + kColumnMargin, across);
  return s;
}

/// First and last column of a row of the box that the triangle can meet; rounding may add one, but leaves out none.
ivec2 columnsInRow(LatticeTriangle t, CellTests s, int row) {
  const dvec3 middle = (double(row) * s.ex - s.besideZ) * s.perColumn;
  const dvec3 least = middle - s.columnReach, most = middle + s.columnReach;
  const double first = max(max(least.x, least.y), max(least.z, double(t.lower.x)));
  const double last = min(min(most.x, most.y), min(most.z, double(t.upper.x)));
  return ivec2(ceil(dvec2(first, -last))) * ivec2(1, -1);
}

bool overlap(dvec3 at, dvec3 reach) { return all(lessThan(abs(at), reach)); }

/// First and last cell of one column that the triangle makes a pair with; first > last where there is none.
ivec2 depthsInColumn(LatticeTriangle t, CellTests s, ivec2 column) {
  const double i = double(column.x), j = double(column.y);
  // The axes that see no depth. In one layer, or in a face plane, there is nothing else to ask.
  precise const dvec3 beside = s.besideZ + i * s.ey - j * s.ex;
  const bool met = overlap(beside, s.reachZ);
  // The others are asked of the three cells that can be near enough to the plane: those around its depth at the column's
  // centre (MATHS.md 2). Its rounding is made up for by a fourth candidate, below, that then takes the first one's place.
  precise const double plane = s.plane + i * s.planeStep.x + j * s.planeStep.y;
  const double lowest = clamp(floor(-plane * s.perDepth - 0.501lf), double(t.lower.z) - 3.0lf, double(t.upper.z) + 1.0lf);
  precise const double farthest = plane + lowest * s.planeStep.z;
  const double first = abs(farthest) < s.planeReach ? lowest : lowest + 1.0lf;
  precise const dvec3 x = s.besideX + j * s.ez - first * s.ey, y = s.besideY - i * s.ez + first * s.ex;
  precise const double p = plane + first * s.planeStep.z;
  const bool m0 = abs(p) < s.planeReach && overlap(x, s.reachX) && overlap(y, s.reachY);
  precise const dvec3 x1 = x - s.ey, y1 = y + s.ex, x2 = x1 - s.ey, y2 = y1 + s.ex;
  precise const double p1 = p + s.planeStep.z, p2 = p1 + s.planeStep.z;
  const bool m1 = abs(p1) < s.planeReach && overlap(x1, s.reachX) && overlap(y1, s.reachY);
  const bool m2 = abs(p2) < s.planeReach && overlap(x2, s.reachX) && overlap(y2, s.reachY);
  ivec2 depths = int(first) + ivec2(m0 ? 0 : m1 ? 1 : m2 ? 2 : 3, m2 ? 2 : m1 ? 1 : m0 ? 0 : -1);
  depths = t.oneLayer ? ivec2(t.lower.z) : ivec2(max(depths.x, t.lower.z), min(depths.y, t.upper.z));
  return met ? depths : ivec2(0, -1);
}
