// Which share of a triangle's area lies within one cell, where nothing else is asked of the part (else its boundary is
// at hand: clip.glsl). Seen along the dominant axis, where shares are the same as in space. The part in the cell's layer
// is outlined by what of the triangle's edges lies in the layer and by the cuts of the layer's two faces. Its area within
// the column is the sum of the areas below these lines (Green), each cut back to the column: one that runs beside it
// counts nothing, one that passes below or above counts at the column's side. All that is decided is on which side of
// the layer a corner lies, so that between two cells nothing is counted twice or left out.

// LPV_VPLS: and where it lies, by the moments of the same areas.

#if LPV_VPLS
#define Below dvec3  // area, its integrals of x and of y

/// Of the area between the line p -> q and y = 0 within the square [-reach, reach]^2; negative towards smaller x.
Below areaBelow(dvec2 p, dvec2 q, double reach) {
  const double first = clamp(p.x, -reach, reach), last = clamp(q.x, -reach, reach);
  if (first == last) return dvec3(0.0lf);
  const double slope = (q.y - p.y) / (q.x - p.x), width = last - first;
  const double a = p.y + (first - p.x) * slope, b = q.y + (last - q.x) * slope;
  // Heights are cut back to the square: even up to `from`, then along the line, even again after `to`.
  const double low = clamp(a, -reach, reach), high = clamp(b, -reach, reach);
  const double from = a == b ? 0.0lf : clamp((low - a) / (b - a), 0.0lf, 1.0lf);
  const double to = a == b ? 1.0lf : clamp((high - a) / (b - a), 0.0lf, 1.0lf);
  const double along = to - from, after = 1.0lf - to;
  const double area = low * from + 0.5lf * (low + high) * along + high * after;
  const double across = 0.5lf * low * from * from + 0.5lf * high * after * (1.0lf + to) +
                        along * (from * (2.0lf * low + high) + to * (low + 2.0lf * high)) / 6.0lf;
  const double squares = 0.5lf * (low * low * from + high * high * after) +
                         along * (low * low + low * high + high * high) / 6.0lf;
  return width * dvec3(area, first * area + width * across, squares);
}

#else
#define Below double

/// Mean over a line from y = a to y = b of y, cut back to [-reach, reach].
double meanHeight(double a, double b, double reach) {
  const double lower = min(a, b), upper = max(a, b), span = upper - lower;
  const double first = clamp(lower, -reach, reach), last = clamp(upper, -reach, reach);
  if (span == 0.0lf) return first;
  const double below = max(min(upper, -reach) - lower, 0.0lf), above = max(upper - max(lower, reach), 0.0lf);
  return (reach * (above - below) + 0.5lf * (first + last) * (last - first)) / span;
}

/// Area between the line p -> q and y = 0 within the square [-reach, reach]^2; negative towards smaller x.
Below areaBelow(dvec2 p, dvec2 q, double reach) {
  const double first = clamp(p.x, -reach, reach), last = clamp(q.x, -reach, reach);
  if (first == last) return 0.0lf;
  const double slope = (q.y - p.y) / (q.x - p.x);
  return (last - first) * meanHeight(p.y + (first - p.x) * slope, q.y + (last - q.x) * slope, reach);
}

#endif

/// The cut of a layer's face through the outline, from where that goes beyond to where it comes back.
struct Cut {
  dvec2 leaves, returns;
};

void crossFace(dvec2 at, bool from, bool to, inout Cut cut) {
  if (!from && to) cut.leaves = at;
  if (from && !to) cut.returns = at;
}

/// Area below the edge p -> q within the layer; adds its ends to the cuts.
Below areaBelowEdge(dvec3 p, dvec3 q, double reach, inout Cut upper, inout Cut lower) {
  const dvec3 d = q - p;
  if (d.z == 0.0lf) return abs(p.z) <= reach ? areaBelow(p.xy, q.xy, reach) : Below(0.0lf);
  const double up = clamp((reach - p.z) / d.z, 0.0lf, 1.0lf), down = clamp((-reach - p.z) / d.z, 0.0lf, 1.0lf);
  const dvec2 high = p.xy + up * d.xy, low = p.xy + down * d.xy;
  crossFace(high, p.z > reach, q.z > reach, upper);
  crossFace(low, p.z < -reach, q.z < -reach, lower);
  return d.z > 0.0lf ? areaBelow(low, high, reach) : areaBelow(high, low, reach);
}

/// `lambda`: with LPV_VPLS the part's centroid, barycentric; else left as it is.
double shareWithin(LatticeTriangle t, ivec3 cell, inout dvec2 lambda) {
  const double reach = 0.5lf * double(kLatticeUnits);
  const dvec3 centre = (dvec3(cell) + 0.5lf) * double(kLatticeUnits);
  const dvec3 a = t.v0 - centre, b = t.v1 - centre, c = t.v2 - centre;
  Below below;
  if (t.oneLayer) {
    below = areaBelow(a.xy, b.xy, reach) + areaBelow(b.xy, c.xy, reach) + areaBelow(c.xy, a.xy, reach);
  } else {
    Cut upper = Cut(dvec2(0.0lf), dvec2(0.0lf)), lower = upper;
    below = areaBelowEdge(a, b, reach, upper, lower) + areaBelowEdge(b, c, reach, upper, lower) +
            areaBelowEdge(c, a, reach, upper, lower);
    below += areaBelow(upper.leaves, upper.returns, reach) + areaBelow(lower.leaves, lower.returns, reach);
  }
#if LPV_VPLS
  const dvec2 middle = below.x == 0.0lf ? dvec2(0.0lf) : clamp(below.yz / below.x, -reach, reach);
  lambda = clamp(barycentric(t, centre.xy, middle), 0.0lf, 1.0lf);
  const double area = below.x;
#else
  const double area = below;
#endif
  return clamp(-2.0lf * area / t.normal.z, 0.0lf, 1.0lf);
}
