// FLUX: what the part of a triangle within a cell emits (MATHS.md 2). Integrals are taken in barycentric coordinates,
// in which the whole triangle has the area 1/2.

/// Share of the triangle's area, and over that share the mean direction and the mean colour.
struct Flux {
  double share;
  dvec3 direction;
  dvec3 colour;
};

#if LPV_DIRECTIONS || LPV_TEXTURED

dvec2 centroidOf(Boundary b) {
  double area = 0.0lf;
  dvec2 moment = dvec2(0.0lf);
  for (int i = 0; i < 9; ++i) {
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
};

/// Weighted sums at the six points of the triangle (o, p, q).
Mean sixPoints(Varying v, dvec2 o, dvec2 p, dvec2 q) {
  Mean mean = Mean(dvec3(0.0lf), dvec3(0.0lf));
  for (int orbit = 0; orbit < 2; ++orbit) {
    const double a = kOrbit[orbit], b = 1.0lf - 2.0lf * a;
    for (int turn = 0; turn < 3; ++turn) {
      const dvec2 at = turn == 0 ? b * o + a * (p + q) : turn == 1 ? b * p + a * (q + o) : b * q + a * (o + p);
#if LPV_DIRECTIONS
      mean.direction += kOrbitWeight[orbit] * dvec3(directionAt(v, at));
#endif
#if LPV_TEXTURED
      mean.colour += kOrbitWeight[orbit] * dvec3(textureAt(uvAt(v, at)));
#endif
    }
  }
  return mean;
}

/// Means over the part, by quadrature on triangles from its centroid to its boundary, each cut into splits^2.
Mean meansBySampling(Varying v, Boundary b, int splits) {
  const dvec2 o = centroidOf(b);
  Mean sum = Mean(dvec3(0.0lf), dvec3(0.0lf));
  double area = 0.0lf;
  for (int i = 0; i < 9; ++i) {
    const dvec2 p = (b.pieces[i].xy - o) / double(splits), q = (b.pieces[i].zw - o) / double(splits);
    const double weight = cross2(p, q);
    if (!(weight > 0.0lf)) continue;
    for (int row = 0; row < splits; ++row) {
      for (int k = 0; k <= 2 * row; ++k) {
        const dvec2 corner = o + double(row) * p + double(k / 2) * (q - p);
        const Mean m = k % 2 == 0 ? sixPoints(v, corner, corner + p, corner + q)
                                  : sixPoints(v, corner, corner + q, corner + q - p);
        sum.direction += weight * m.direction;
        sum.colour += weight * m.colour;
        area += weight;
      }
    }
  }
  if (area > 0.0lf) {
    sum.direction /= area;
    sum.colour /= area;
  } else {
    sum.direction = dvec3(directionAt(v, o));
#if LPV_TEXTURED
    sum.colour = dvec3(textureAt(uvAt(v, o)));
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
  return least > 0.5 ? 1 : least > 0.0 ? 2 : least > -0.5 ? 4 : 8;
}
#endif

#if LPV_TEXTURED
/// A line or a point of the texture stretched over the triangle has no area there to integrate over.
const double kFlatTexture = 1e-9lf;
const int kFlatSplits = 8;

dvec3 meanColour(Varying v, Boundary b, double share) {
  const dvec2 along = v.uv[1] - v.uv[0], across = v.uv[2] - v.uv[0];
  const double texels = cross2(along, across);
  if (!(abs(texels) > kFlatTexture * max(dot(along, along), dot(across, across))) || share <= 0.0lf) {
    return meansBySampling(v, b, kFlatSplits).colour;
  }
  dvec3 sum = dvec3(0.0lf);
  for (int i = 0; i < 9; ++i) {
    if (b.pieces[i].xy == b.pieces[i].zw) continue;
    sum += lineIntegral(uvAt(v, b.pieces[i].xy), uvAt(v, b.pieces[i].zw));
  }
  return max(sum * (2.0lf / (texels * share)), dvec3(0.0lf));
}
#endif

/// `share` of the triangle, bounded by `b` (barycentric).
Flux fluxOf(Varying v, Boundary b, double share) {
  Flux flux = Flux(share, dvec3(v.normal), dvec3(1.0lf));
#if LPV_DIRECTIONS
  flux.direction = meansBySampling(v, b, splitsFor(v)).direction;
#endif
#if LPV_TEXTURED
  flux.colour = meanColour(v, b, share);
#endif
  return flux;
}
