// The part of a triangle within one cell, as its boundary seen along the dominant axis: at most three pieces of the
// triangle's edges and one piece of each of six cell faces. What is wanted of the part (area, box, integrals) is a sum
// over these pieces, so their order does not matter and nothing is stored per corner.
//
// No piece is counted twice: a piece of an edge counts when it is in the closed box; a cut along a face counts only when
// a corner lies strictly beyond the face; and where the plane of the triangle contains cell edges (two faces cut it in
// parallel lines) the depth slab is merged into the other one, so that one number decides for both.

/// Pieces (x0, y0, x1, y1), counter-clockwise, in lattice units from the cell's centre; zeros where there is none.
struct Boundary {
  dvec4 pieces[9];
};

struct Box {
  dvec3 lower, upper;
};

/// Cuts [s.x, s.y] of p + s d to lower <= p + s d <= upper; false when nothing is left.
bool narrow(double p, double d, double lower, double upper, inout dvec2 s) {
  if (d == 0.0lf) return lower <= p && p <= upper;
  const double first = (lower - p) / d, second = (upper - p) / d;
  s = dvec2(max(s.x, min(first, second)), min(s.y, max(first, second)));
  return s.x < s.y;
}

dvec4 pieceOf(dvec3 p, dvec3 d, dvec2 s) { return dvec4(p.xy + s.x * d.xy, p.xy + s.y * d.xy); }

dvec4 turnedRound(dvec4 piece) { return piece.zwxy; }

/// The edge p -> q within the box.
dvec4 edgeWithin(dvec3 p, dvec3 q, Box box) {
  const dvec3 d = q - p;
  dvec2 s = dvec2(0.0lf, 1.0lf);
  if (!narrow(p.x, d.x, box.lower.x, box.upper.x, s) || !narrow(p.y, d.y, box.lower.y, box.upper.y, s) ||
      !narrow(p.z, d.z, box.lower.z, box.upper.z, s)) {
    return dvec4(0.0lf);
  }
  return pieceOf(p, d, s);
}

/// Where p -> q crosses the face at `at` on axis k.
dvec3 crossing(dvec3 p, dvec3 q, int k, double at) { return p + (q - p) * ((at - p[k]) / (q[k] - p[k])); }

/// The cut of a face (`side` 1: upper, -1: lower) through the triangle, within the box, running along `direction`.
dvec4 cutWithin(dvec3 a, dvec3 b, dvec3 c, int k, double side, dvec2 direction, Box box) {
  const double at = side > 0.0lf ? box.upper[k] : box.lower[k];
  const bool beyondA = side * (a[k] - at) > 0.0lf;
  const bool beyondB = side * (b[k] - at) > 0.0lf;
  const bool beyondC = side * (c[k] - at) > 0.0lf;
  if (beyondA == beyondB && beyondB == beyondC) return dvec4(0.0lf);
  // The corner that is alone on its side, and the two edges that leave it.
  const dvec3 alone = beyondB == beyondC ? a : beyondA == beyondC ? b : c;
  const dvec3 other = beyondB == beyondC ? b : beyondA == beyondC ? c : a;
  const dvec3 third = beyondB == beyondC ? c : beyondA == beyondC ? a : b;
  const dvec3 p = crossing(alone, other, k, at);
  const dvec3 d = crossing(alone, third, k, at) - p;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  dvec2 s = dvec2(0.0lf, 1.0lf);
  if (!narrow(p[i], d[i], box.lower[i], box.upper[i], s) || !narrow(p[j], d[j], box.lower[j], box.upper[j], s)) {
    return dvec4(0.0lf);
  }
  const dvec4 piece = pieceOf(p, d, s);
  return dot(d.xy, direction) < 0.0lf ? turnedRound(piece) : piece;
}

const double kNoLimit = 1e30lf;

/// The cell around its own centre. The depth slab is left out where it does not matter (`depthless`), and merged into
/// the slab of the one axis that depth varies along.
Box boxOf(dvec3 a, dvec3 normal, bool depthless) {
  const double half_ = 0.5lf * double(kLatticeUnits);
  Box box = Box(dvec3(-half_), dvec3(half_));
  const bool alongX = normal.y == 0.0lf, alongY = normal.x == 0.0lf;
  if (!depthless && alongX != alongY) {
    const int k = alongX ? 0 : 1;
    const double slope = normal.z / normal[k];
    const double first = a[k] + (a.z - half_) * slope, second = a[k] + (a.z + half_) * slope;
    box.lower[k] = max(box.lower[k], min(first, second));
    box.upper[k] = min(box.upper[k], max(first, second));
  }
  if (depthless || alongX || alongY) {
    box.lower.z = -kNoLimit;
    box.upper.z = kNoLimit;
  }
  return box;
}

/// The triangle within a (turned) cell; within the cell's whole column when `depthless`.
Boundary boundaryWithin(LatticeTriangle t, ivec3 cell, bool depthless) {
  const dvec3 centre = (dvec3(cell) + 0.5lf) * double(kLatticeUnits);
  const dvec3 a = t.v0 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const dvec3 b = t.v1 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const dvec3 c = t.v2 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const Box box = boxOf(a, t.normal, depthless || t.oneLayer);
  const bool clockwise = t.normal.z < 0.0lf;
  Boundary out_;
  out_.pieces[0] = edgeWithin(a, b, box);
  out_.pieces[1] = edgeWithin(b, c, box);
  out_.pieces[2] = edgeWithin(c, a, box);
  if (clockwise) {
    for (int i = 0; i < 3; ++i) out_.pieces[i] = turnedRound(out_.pieces[i]);
  }
  out_.pieces[3] = cutWithin(a, b, c, 0, 1.0lf, dvec2(0.0lf, 1.0lf), box);
  out_.pieces[4] = cutWithin(a, b, c, 0, -1.0lf, dvec2(0.0lf, -1.0lf), box);
  out_.pieces[5] = cutWithin(a, b, c, 1, 1.0lf, dvec2(-1.0lf, 0.0lf), box);
  out_.pieces[6] = cutWithin(a, b, c, 1, -1.0lf, dvec2(1.0lf, 0.0lf), box);
  out_.pieces[7] = dvec4(0.0lf);
  out_.pieces[8] = dvec4(0.0lf);
  if (box.upper.z != kNoLimit) {
    const dvec2 above = (clockwise ? -1.0lf : 1.0lf) * dvec2(t.normal.y, -t.normal.x);
    out_.pieces[7] = cutWithin(a, b, c, 2, 1.0lf, above, box);
    out_.pieces[8] = cutWithin(a, b, c, 2, -1.0lf, -above, box);
  }
  return out_;
}

double cross2(dvec2 p, dvec2 q) { return p.x * q.y - p.y * q.x; }

/// Share of the triangle's area that the boundary encloses (Green).
double enclosedShare(Boundary boundary, LatticeTriangle t) {
  double twice = 0.0lf;
  for (int i = 0; i < 9; ++i) twice += cross2(boundary.pieces[i].xy, boundary.pieces[i].zw);
  return clamp(twice / abs(t.normal.z), 0.0lf, 1.0lf);
}
