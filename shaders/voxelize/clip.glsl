// The part of a triangle within one cell, as its boundary seen along the dominant axis: at most three pieces of the
// triangle's edges and one piece of each of six cell faces. What is wanted of the part (its box, integrals over it) is
// gathered over these pieces, so their order does not matter and nothing is stored per corner.
//
// No piece is counted twice: a piece of an edge counts when it is in the closed box; a cut along a face counts only when
// a corner lies strictly beyond the face; and where the plane of the triangle contains cell edges (two faces cut it in
// parallel lines) the depth slab is merged into the other one, so that one number decides for both.

const int kMostPieces = 9;

/// A closed line of pieces (x0, y0, x1, y1), in no order, or what is wanted of it.
struct Boundary {
#if LPV_FLUX
  dvec4 pieces[kMostPieces];  // zeros where there is none; indexed by constants only, else they lie in memory
  int count;                  // none beyond these
#else
  dvec2 lower, upper;         // box around it
#endif
};

const double kNoLimit = 1e30lf;

Boundary noBoundary() {
  Boundary b;
#if LPV_FLUX
  for (int i = 0; i < kMostPieces; ++i) b.pieces[i] = dvec4(0.0lf);
  b.count = 0;
#else
  b.lower = dvec2(kNoLimit);
  b.upper = dvec2(-kNoLimit);
#endif
  return b;
}

void addPiece(int at, dvec4 piece, inout Boundary b) {
#if LPV_FLUX
  b.pieces[at] = piece;
  b.count = at + 1;
#else
  if (piece.xy == piece.zw) return;
  b.lower = min(b.lower, min(piece.xy, piece.zw));
  b.upper = max(b.upper, max(piece.xy, piece.zw));
#endif
}

struct Box {
  dvec3 lower, upper;
};

#if LPV_FLUX
/// b.pieces[i] for an i that is known only when it runs. With a loop over b.count, what is done to a piece is compiled
/// once, not nine times.
dvec4 pieceAt(Boundary b, int i) {
  dvec4 piece = b.pieces[0];
  for (int k = 1; k < kMostPieces; ++k) piece = i == k ? b.pieces[k] : piece;
  return piece;
}
#endif

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

/// v[k]. NVIDIA's compiler has no code for setting a component of doubles by number; reading one is written out as well.
double component(dvec3 v, int k) { return k == 0 ? v.x : k == 1 ? v.y : v.z; }

/// Where p -> q crosses the face at `at` on axis k.
dvec3 crossing(dvec3 p, dvec3 q, int k, double at) {
  const double from = component(p, k);
  return p + (q - p) * ((at - from) / (component(q, k) - from));
}

/// The cut of a face (`side` 1: upper, -1: lower) through the triangle, within the box, running along `direction`.
dvec4 cutWithin(dvec3 a, dvec3 b, dvec3 c, int k, double side, dvec2 direction, Box box) {
  const double at = component(side > 0.0lf ? box.upper : box.lower, k);
  const bool beyondA = side * (component(a, k) - at) > 0.0lf;
  const bool beyondB = side * (component(b, k) - at) > 0.0lf;
  const bool beyondC = side * (component(c, k) - at) > 0.0lf;
  if (beyondA == beyondB && beyondB == beyondC) return dvec4(0.0lf);
  // The corner that is alone on its side, and the two edges that leave it.
  const dvec3 alone = beyondB == beyondC ? a : beyondA == beyondC ? b : c;
  const dvec3 other = beyondB == beyondC ? b : beyondA == beyondC ? c : a;
  const dvec3 third = beyondB == beyondC ? c : beyondA == beyondC ? a : b;
  const dvec3 p = crossing(alone, other, k, at);
  const dvec3 d = crossing(alone, third, k, at) - p;
  const int i = (k + 1) % 3, j = (k + 2) % 3;
  dvec2 s = dvec2(0.0lf, 1.0lf);
  if (!narrow(component(p, i), component(d, i), component(box.lower, i), component(box.upper, i), s) ||
      !narrow(component(p, j), component(d, j), component(box.lower, j), component(box.upper, j), s)) {
    return dvec4(0.0lf);
  }
  const dvec4 piece = pieceOf(p, d, s);
  return dot(d.xy, direction) < 0.0lf ? turnedRound(piece) : piece;
}

/// The cell around its own centre. The depth slab is left out where it does not matter (`depthless`), and merged into
/// the slab of the one axis that depth varies along.
Box boxOf(dvec3 a, dvec3 normal, bool depthless) {
  const double half_ = 0.5lf * double(kLatticeUnits);
  Box box = Box(dvec3(-half_), dvec3(half_));
  const bool alongX = normal.y == 0.0lf, alongY = normal.x == 0.0lf;
  if (!depthless && alongX != alongY) {
    const double slope = normal.z / (alongX ? normal.x : normal.y), middle = alongX ? a.x : a.y;
    const double first = middle + (a.z - half_) * slope, second = middle + (a.z + half_) * slope;
    const dvec2 range = dvec2(max(-half_, min(first, second)), min(half_, max(first, second)));
    if (alongX) {
      box.lower.x = range.x;
      box.upper.x = range.y;
    } else {
      box.lower.y = range.x;
      box.upper.y = range.y;
    }
  }
  if (depthless || alongX || alongY) {
    box.lower.z = -kNoLimit;
    box.upper.z = kNoLimit;
  }
  return box;
}

/// The triangle within a (turned) cell, counter-clockwise, in lattice units from the cell's centre; within the cell's
/// whole column when `depthless`.
Boundary boundaryWithin(LatticeTriangle t, ivec3 cell, bool depthless) {
  const dvec3 centre = (dvec3(cell) + 0.5lf) * double(kLatticeUnits);
  const dvec3 a = t.v0 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const dvec3 b = t.v1 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const dvec3 c = t.v2 - dvec3(centre.xy, depthless ? 0.0lf : centre.z);
  const Box box = boxOf(a, t.normal, depthless || t.oneLayer);
  const bool clockwise = t.normal.z < 0.0lf;
  Boundary part = noBoundary();
  for (int i = 0; i < 3; ++i) {
    const dvec4 piece = edgeWithin(i == 0 ? a : i == 1 ? b : c, i == 0 ? b : i == 1 ? c : a, box);
    addPiece(i, clockwise ? turnedRound(piece) : piece, part);
  }
  addPiece(3, cutWithin(a, b, c, 0, 1.0lf, dvec2(0.0lf, 1.0lf), box), part);
  addPiece(4, cutWithin(a, b, c, 0, -1.0lf, dvec2(0.0lf, -1.0lf), box), part);
  addPiece(5, cutWithin(a, b, c, 1, 1.0lf, dvec2(-1.0lf, 0.0lf), box), part);
  addPiece(6, cutWithin(a, b, c, 1, -1.0lf, dvec2(1.0lf, 0.0lf), box), part);
  if (box.upper.z != kNoLimit) {
    const dvec2 above = (clockwise ? -1.0lf : 1.0lf) * dvec2(t.normal.y, -t.normal.x);
    addPiece(7, cutWithin(a, b, c, 2, 1.0lf, above, box), part);
    addPiece(8, cutWithin(a, b, c, 2, -1.0lf, -above, box), part);
  }
  return part;
}

#if LPV_FLUX
/// Share of the triangle's area that its part's boundary encloses (Green).
double enclosedShare(Boundary b, LatticeTriangle t) {
  double twice = 0.0lf;
  for (int i = 0; i < kMostPieces; ++i) twice += cross2(b.pieces[i].xy, b.pieces[i].zw);
  return clamp(twice / abs(t.normal.z), 0.0lf, 1.0lf);
}
#endif
