// FLUX: what the part of a triangle within a cell emits (MATHS.md 2). Integrals are taken in barycentric coordinates,
// in which the whole triangle has the area 1/2.

/// Share of the triangle's area, and over that share the mean colour and, for each colour, the mean direction.
struct Flux {
  double share;
  dmat3 direction;
  dvec3 colour;
};

/// Where a part emits from, barycentric: its middle, and its covariance about that (xx, yy, xy).
struct Place {
  dvec2 middle;
  dvec3 covariance;
};

dmat3 sameForAll(dvec3 direction) { return dmat3(direction, direction, direction); }

/// Of one colour, about the normal.
Flux evenFlux(Varying v, double share) { return Flux(share, sameForAll(dvec3(v.normal)), dvec3(1.0lf)); }

#if LPV_VPLS
/// One direction for all colours: unit but where directions spread.
dvec3 meanDirection(Flux flux) {
#if LPV_DIRECTIONS && LPV_TEXTURED
  const double sum = flux.colour.r + flux.colour.g + flux.colour.b;
  return sum > 0.0lf ? flux.direction * flux.colour / sum : flux.direction[0];
#else
  return flux.direction[0];
#endif
}
#endif

#if LPV_OUTLINED
/// Of what emits evenly.
Place placeOf(Boundary b) {
  double area = 0.0lf;
  dvec2 first = dvec2(0.0lf);
  dvec3 second = dvec3(0.0lf);
  for (int i = 0; i < kMostPieces; ++i) {
    const dvec2 p = b.pieces[i].xy, q = b.pieces[i].zw, s = p + q;
    const double twice = cross2(p, q);
    area += twice;
    first += twice * s;
    second += twice * dvec3(p * p + q * q + s * s, p.x * p.y + q.x * q.y + s.x * s.y);
  }
  if (!(area > 0.0lf)) return Place(dvec2(1.0lf / 3.0lf), dvec3(0.0lf));
  const dvec2 middle = first / (3.0lf * area);
  return Place(middle, second / (12.0lf * area) - dvec3(middle * middle, middle.x * middle.y));
}
#endif

#if LPV_DIRECTIONS || LPV_TEXTURED

/// In the boundary's own coordinates.
dvec2 centroidOf(Boundary b) {
  double area = 0.0lf;
  dvec2 moment = dvec2(0.0lf);
  for (int i = 0; i < kMostPieces; ++i) {
    const double twice = cross2(b.pieces[i].xy, b.pieces[i].zw);
    area += twice;
    moment += twice * (b.pieces[i].xy + b.pieces[i].zw);
  }
  return area > 0.0lf ? moment / (3.0lf * area) : dvec2(1.0lf / 3.0lf);
}

// Six points of degree 4 on a triangle (Strang & Fix): two orbits of three.
const dvec2 kOrbit = dvec2(0.44594849091596488632lf, 0.09157621350977074346lf);
const dvec2 kOrbitWeight = dvec2(0.22338158967801146570lf, 0.10995174365532186764lf);

struct Mean {
  dvec3 direction, colour;
  dmat3 product;  // colour x direction
};

Mean noMean() { return Mean(dvec3(0.0lf), dvec3(0.0lf), dmat3(0.0lf)); }

void addPoint(Varying v, dvec2 at, double weight, inout Mean mean) {
#if LPV_DIRECTIONS
  const dvec3 direction = weight * dvec3(directionAt(v, at));
  mean.direction += direction;
#endif
#if LPV_TEXTURED
  const dvec3 colour = dvec3(textureAt(uvAt(v, at)));
  mean.colour += weight * colour;
#endif
#if LPV_DIRECTIONS && LPV_TEXTURED
  mean.product += outerProduct(direction, colour);
#endif
}

/// Weighted sums at the six points of the triangle (o, p, q). Without a loop: kMaxVaryingSlices.
Mean sixPoints(Varying v, dvec2 o, dvec2 p, dvec2 q) {
  Mean mean = noMean();
  const dvec2 a = kOrbit, b = 1.0lf - 2.0lf * kOrbit, w = kOrbitWeight;
  addPoint(v, b.x * o + a.x * (p + q), w.x, mean);
  addPoint(v, b.x * p + a.x * (q + o), w.x, mean);
  addPoint(v, b.x * q + a.x * (o + p), w.x, mean);
  addPoint(v, b.y * o + a.y * (p + q), w.y, mean);
  addPoint(v, b.y * p + a.y * (q + o), w.y, mean);
  addPoint(v, b.y * q + a.y * (o + p), w.y, mean);
  return mean;
}

/// Means over the part, by quadrature on triangles from its centroid to its boundary, each cut into splits^2.
Mean meansBySampling(Varying v, Boundary b, int splits) {
  const dvec2 o = centroidOf(b);
  Mean sum = noMean();
  double area = 0.0lf;
  for (int i = 0; i < b.count; ++i) {
    const dvec4 piece = pieceAt(b, i);
    const dvec2 p = (piece.xy - o) / double(splits), q = (piece.zw - o) / double(splits);
    const double weight = cross2(p, q);
    if (!(weight > 0.0lf)) continue;
    for (int row = 0; row < splits; ++row) {
      for (int k = 0; k <= 2 * row; ++k) {
        const dvec2 corner = o + double(row) * p + double(k / 2) * (q - p);
        const bool upright = k % 2 == 0;
        const Mean m = sixPoints(v, corner, corner + (upright ? p : q), corner + (upright ? q : q - p));
        sum.direction += weight * m.direction;
        sum.colour += weight * m.colour;
#if LPV_DIRECTIONS && LPV_TEXTURED
        sum.product += weight * m.product;
#endif
        area += weight;
      }
    }
  }
  if (area > 0.0lf) {
    sum.direction /= area;
    sum.colour /= area;
    sum.product /= area;
  } else {
    sum.direction = dvec3(directionAt(v, o));
#if LPV_TEXTURED
    sum.colour = dvec3(textureAt(uvAt(v, o)));
    sum.product = outerProduct(sum.direction, sum.colour);
#endif
  }
  return sum;
}

#endif

#if LPV_DIRECTIONS
/// Finer where the directions of the corners spread: the normalised interpolation bends.
int splitsFor(Varying v) {
  const float least = min(dot(v.direction[0], v.direction[1]),
                          min(dot(v.direction[1], v.direction[2]), dot(v.direction[2], v.direction[0])));
  return least > 0.5 ? 1 : least > 0.0 ? 2 : least > -0.5 ? 4 : least > -0.9 ? 8 : 16;
}
#endif

/// Whether the integrals over parts of this triangle take many steps: then a thread takes few of them.
bool laborious(Varying v) {
  bool much = false;
#if LPV_DIRECTIONS
  much = splitsFor(v) > 4;
#endif
#if LPV_TEXTURED
  const dvec2 extent = max(abs(v.uv[1] - v.uv[0]), abs(v.uv[2] - v.uv[0]));
  much = much || extent.x + extent.y > 1024.0lf || (LPV_DIRECTIONS == 1 && extent.x * extent.y > 16.0lf);
#endif
  return much;
}

#if LPV_TEXTURED
/// A texture is at least so wide across, as a share of its length along: a line of it that is stretched over the
/// triangle has no area to integrate over, and this much blurs nothing.
const double kThinnest = 1e-7lf;
/// One so narrow, a part so dark (as a share of the brightest texel) or so small (texels, as a share of the distance from
/// the first one) has no digits left for where it glows: it is taken to emit evenly.
const double kFlattest = 1e-4lf, kDarkest = 1e-9lf, kSmallest = 5e-5lf;

void widen(inout dvec2 along, inout dvec2 across) {
  const double by = cross2(along, across) < 0.0lf ? -kThinnest : kThinnest;
  if (dot(along, along) >= dot(across, across)) across += by * dvec2(-along.y, along.x);
  else along -= by * dvec2(-across.y, across.x);
}

/// `place`, with LPV_VPLS: of what emits evenly; becomes that of what glows.
dvec3 meanColour(Varying v, Boundary b, double share, inout Place place) {
  dvec2 along = v.uv[1] - v.uv[0], across = v.uv[2] - v.uv[0];
  const double size = max(dot(along, along), dot(across, across));
  if (size == 0.0lf || share <= 0.0lf) return dvec3(textureAt(uvAt(v, centroidOf(b))));
  const bool line = abs(cross2(along, across)) < kThinnest * size;
#if LPV_VPLS
  const dvec2 far = max(max(abs(v.uv[0]), abs(v.uv[1])), abs(v.uv[2]));
  const double least = kSmallest * max(far.x, far.y);
  const double area = abs(cross2(along, across));
  const bool told = area > kFlattest * size && area * share > least * least;
#endif
  if (line) widen(along, across);
  v.uv[1] = v.uv[0] + along;
  v.uv[2] = v.uv[0] + across;
  const double texels = cross2(along, across);
  TextureIntegral sum = noIntegral();
  for (int i = 0; i < b.count; ++i) {
    const dvec4 piece = pieceAt(b, i);
    if (piece.xy != piece.zw) addLine(uvAt(v, piece.xy), uvAt(v, piece.zw), sum);
  }
#if LPV_VPLS
  if (told && sum.glow / texels > kDarkest * share) {
    const dvec2 uv = sum.first / sum.glow;
    const dvec3 square = sum.second / sum.glow - dvec3(uv * uv, uv.x * uv.y);
    // Of texel space to barycentric coordinates.
    const dvec2 x = dvec2(across.y, -across.x) / texels, y = dvec2(-along.y, along.x) / texels;
    place.middle = dvec2(dot(x, uv - v.uv[0]), dot(y, uv - v.uv[0]));
    const dvec2 cx = dvec2(square.x * x.x + square.z * x.y, square.z * x.x + square.y * x.y);
    const dvec2 cy = dvec2(square.x * y.x + square.z * y.y, square.z * y.x + square.y * y.y);
    place.covariance = dvec3(dot(x, cx), dot(y, cy), dot(x, cy));
  }
#endif
  return max(sum.colour * (2.0lf / (texels * share)), dvec3(0.0lf));
}
#endif

#if LPV_DIRECTIONS && LPV_TEXTURED
const int kMostSplits = 8;

/// Directions weighted by colour: as fine as the texels under the part, up to kMostSplits.
int splitsForBoth(Varying v, double share) {
  const double texels = abs(cross2(v.uv[1] - v.uv[0], v.uv[2] - v.uv[0])) * share;
  return max(splitsFor(v), int(ceil(sqrt(min(texels, double(kMostSplits * kMostSplits))))));
}

dvec3 directionOf(dvec3 product, double colour, dvec3 otherwise) { return colour > 0.0lf ? product / colour : otherwise; }

dmat3 directionsByColour(Varying v, Boundary b, double share) {
  const Mean mean = meansBySampling(v, b, splitsForBoth(v, share));
  return dmat3(directionOf(mean.product[0], mean.colour.x, mean.direction),
               directionOf(mean.product[1], mean.colour.y, mean.direction),
               directionOf(mean.product[2], mean.colour.z, mean.direction));
}
#endif

#if LPV_OUTLINED
/// `share` of the triangle, bounded by `b` (barycentric). `place`: of what emits evenly; becomes that of what glows.
Flux fluxOf(Varying v, Boundary b, double share, inout Place place) {
  Flux flux = evenFlux(v, share);
#if LPV_DIRECTIONS && LPV_TEXTURED
  flux.direction = directionsByColour(v, b, share);
#elif LPV_DIRECTIONS
  flux.direction = sameForAll(meansBySampling(v, b, splitsFor(v)).direction);
#endif
#if LPV_TEXTURED
  flux.colour = meanColour(v, b, share, place);
#endif
  return flux;
}
#endif
