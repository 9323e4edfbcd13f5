// A triangle that snapping makes a segment (MATHS.md 2): its corners lie on one line of the lattice, which passes from
// cell to cell along the axis of its longest extent. Places on the segment are told by that axis' coordinate u, which
// is an integer at the corners and linear over the triangle. A pair is a cell in which a piece of some length lies; a
// segment in a cell face belongs to the upper cell, or the last one of the grid, as a triangle there does. A pair's
// share is that of the triangle's area whose u is in the piece.

struct Segment {
  dvec3 from, to;  // its ends in lattice units, turned so that u is the third coordinate and grows
  dvec3 places;    // u of the triangle's corners
  ivec3 dims;      // of the grid, turned the same way
  int axis;        // of u
};

/// Of a degenerate triangle, which has not been turned.
Segment segmentOf(LatticeTriangle t) {
  const dvec3 a = t.v0, b = t.v1, c = t.v2;
  const dvec3 extent = max(a, max(b, c)) - min(a, min(b, c));
  Segment s;
  s.axis = extent.z >= extent.x && extent.z >= extent.y ? 2 : extent.y >= extent.x ? 1 : 0;
  const dvec3 p = turned(a, s.axis), q = turned(b, s.axis), r = turned(c, s.axis);
  s.places = dvec3(p.z, q.z, r.z);
  const double least = min(p.z, min(q.z, r.z)), most = max(p.z, max(q.z, r.z));
  s.from = p.z == least ? p : q.z == least ? q : r;
  s.to = p.z == most ? p : q.z == most ? q : r;
  s.dims = turned(t.dims, s.axis);
  return s;
}

/// The pieces of a segment in one layer of cells, in their order: at most three, as nothing is longer than u.
struct Passage {
  int count;
  ivec2 cells[3];
  double cuts[4];  // u between them
};

/// Of one axis beside u within a layer: the cells where it enters and leaves, and how far along the whole segment the
/// face between them is, as over / of; integers.
struct Beside {
  int enters, leaves;
  double over, of;
};

Beside besideOf(Segment s, int k, double a, double b) {
  const double along = s.to.z - s.from.z, across = s.to[k] - s.from[k];
  // Times `along`: no rounding.
  precise const double first = s.from[k] * along + across * (a - s.from.z), last = s.from[k] * along + across * (b - s.from.z);
  const ivec2 range = cellRange(min(first, last), max(first, last), double(kLatticeUnits) * along, s.dims[k]);
  const double face = double(kLatticeUnits) * double(range.y);
  if (across >= 0.0lf) return Beside(range.x, range.y, face - s.from[k], across);
  return Beside(range.y, range.x, s.from[k] - face, -across);
}

Passage passageOf(Segment s, int layer) {
  const double a = max(s.from.z, double(kLatticeUnits) * double(layer));
  const double b = min(s.to.z, double(kLatticeUnits) * double(layer + 1));
  const double along = s.to.z - s.from.z;
  const Beside x = besideOf(s, 0, a, b), y = besideOf(s, 1, a, b);
  const bool inX = x.enters != x.leaves, inY = y.enters != y.leaves;
  const double atX = inX ? clamp(s.from.z + along * (x.over / x.of), a, b) : b;
  const double atY = inY ? clamp(s.from.z + along * (y.over / y.of), a, b) : b;
  precise const double sooner = x.over * y.of - y.over * x.of;  // below 0: x is crossed first
  Passage p;
  p.count = 1;
  p.cells[0] = ivec2(x.enters, y.enters);
  p.cuts[0] = a;
  if (inX && inY && sooner != 0.0lf) {
    p.cells[1] = sooner < 0.0lf ? ivec2(x.leaves, y.enters) : ivec2(x.enters, y.leaves);
    p.cuts[1] = sooner < 0.0lf ? atX : atY;
    p.cuts[2] = sooner < 0.0lf ? atY : atX;
    p.count = 3;
  } else if (inX || inY) {
    p.cuts[1] = min(atX, atY);
    p.count = 2;
  }
  p.cells[p.count - 1] = ivec2(x.leaves, y.leaves);
  p.cuts[p.count] = b;
  return p;
}

/// The part of a triangle between two places, as a closed line of pieces (x0, y0, x1, y1), barycentric.
const int kStripPieces = 5;
struct Strip {
  dvec4 pieces[kStripPieces];
};

/// Where an edge crosses a place going out, and where one comes back.
void crossPlace(dvec2 at, bool from, bool to, inout dvec4 cut) {
  if (from && !to) cut.xy = at;
  if (!from && to) cut.zw = at;
}

Strip stripOf(dvec3 places, double a, double b) {
  const dvec2 corners[3] = dvec2[3](dvec2(0.0lf), dvec2(1.0lf, 0.0lf), dvec2(0.0lf, 1.0lf));
  Strip strip;
  strip.pieces[3] = strip.pieces[4] = dvec4(0.0lf);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double u = places[i], across = places[j] - u;
    strip.pieces[i] = dvec4(0.0lf);
    if (across == 0.0lf) continue;  // at an end, where the cut is the edge
    const dvec2 p = corners[i], d = corners[j] - p;
    const double atA = clamp((a - u) / across, 0.0lf, 1.0lf), atB = clamp((b - u) / across, 0.0lf, 1.0lf);
    const dvec2 pa = p + atA * d, pb = p + atB * d;
    strip.pieces[i] = across > 0.0lf ? dvec4(pa, pb) : dvec4(pb, pa);
    crossPlace(pa, u > a, places[j] > a, strip.pieces[3]);
    crossPlace(pb, u < b, places[j] < b, strip.pieces[4]);
  }
  return strip;
}

/// Share of the triangle's area (the whole is 1/2 in barycentric coordinates) and barycentric centroid.
double shareOf(Strip strip, out dvec2 lambda) {
  double twice = 0.0lf;
  dvec2 moment = dvec2(0.0lf);
  for (int i = 0; i < kStripPieces; ++i) {
    const dvec4 piece = strip.pieces[i];
    const double by = cross2(piece.xy, piece.zw);
    twice += by;
    moment += by * (piece.xy + piece.zw);
  }
  lambda = twice > 0.0lf ? clamp(moment / (3.0lf * twice), 0.0lf, 1.0lf) : dvec2(1.0lf / 3.0lf);
  return clamp(twice, 0.0lf, 1.0lf);
}
