// COUNT: the clamped cosine lobes of what lies in one column of cells (paper 3.2, 3.3). Emission varies over the box
// around the triangle's part in the column, seen along the dominant axis: directions at its four corners with lobes
// spread between them, the radiance factor one mip-mapped sample at its centre.

struct Lobes {
  uint count;
  vec3 directions;   // sum of unit vectors
  vec3 colour;
};

/// Lobes between two directions are this far apart: as wide as a clamped cosine lobe is.
const float kLobeAngle = 1.57079632679489661923;
/// Rounding gives equal directions an angle, and a right one a little more.
const float kAngleTolerance = 1e-3;

bool laborious(Varying v) { return false; }

#if LPV_DIRECTIONS || LPV_TEXTURED

float angleBetween(vec3 a, vec3 b) { return atan(length(cross(a, b)), dot(a, b)); }

int lobesAcross(float angle) { return 1 + max(0, int(ceil((angle - kAngleTolerance) / kLobeAngle))); }

#endif

#if LPV_DIRECTIONS
/// `corners`: barycentric, at (0,0), (1,0), (0,1), (1,1) of the box.
void spreadLobes(Varying v, dvec2 corners[4], inout Lobes lobes) {
  vec3 d[4];
  for (int i = 0; i < 4; ++i) d[i] = directionAt(v, corners[i]);
  const int across = lobesAcross(max(angleBetween(d[0], d[1]), angleBetween(d[2], d[3])));
  const int along = lobesAcross(max(angleBetween(d[0], d[2]), angleBetween(d[1], d[3])));
  lobes.directions = vec3(0.0);
  for (int j = 0; j < along; ++j) {
    for (int i = 0; i < across; ++i) {
      const float x = across > 1 ? float(i) / float(across - 1) : 0.5;
      const float y = along > 1 ? float(j) / float(along - 1) : 0.5;
      lobes.directions += unitOr(dvec3(mix(mix(d[0], d[1], x), mix(d[2], d[3], x), y)), v.normal);
    }
  }
  lobes.count = uint(across * along);
}
#endif

#if LPV_TEXTURED
#if LPV_EXACT_FILTER
vec3 filtered(vec2 uv, float level) { return textureLod(lightTexture, uv, level).rgb; }
#else
vec3 filteredIn(int level, vec2 uv) {
  const ivec2 size = max(params.textureSize >> level, 1);
  const vec2 at = uv * vec2(size) - 0.5, share = fract(at);
  const ivec2 low = (ivec2(floor(at)) + size) % size, high = (low + 1) % size;
  return mix(mix(texelFetch(lightTexture, low, level), texelFetch(lightTexture, ivec2(high.x, low.y), level), share.x),
             mix(texelFetch(lightTexture, ivec2(low.x, high.y), level), texelFetch(lightTexture, high, level), share.x), share.y).rgb;
}

/// With weights in floats (lookup.glsl: between).
vec3 filtered(vec2 uv, float level) {
  const int finer = int(level);
  return mix(filteredIn(finer, uv), filteredIn(min(finer + 1, params.textureLevels - 1), uv), fract(level));
}
#endif

/// One sample at `centre`, of the mip level whose texels are as large as the box.
vec3 boxColour(Varying v, dvec2 centre, dvec2 corners[4]) {
  dvec2 least = uvAt(v, corners[0]), most = least;
  for (int i = 1; i < 4; ++i) {
    const dvec2 at = uvAt(v, corners[i]);
    least = min(least, at);
    most = max(most, at);
  }
  const vec2 texels = vec2(most - least);
  const float level = log2(max(max(texels.x, texels.y), 1.0));
  const dvec2 uv = (uvAt(v, centre) + 0.5lf) / dvec2(params.textureSize);
  const float finest = float(params.textureLevels - 1);
  return filtered(vec2(uv - floor(uv)), min(level, finest)) * float(params.colourScale);
}
#endif

/// The lobes of a triangle that is one point to the grid.
Lobes lobesAtPoint(Varying v, dvec2 lambda) {
  Lobes lobes = Lobes(1u, directionAt(v, lambda), vec3(1.0));
#if LPV_TEXTURED
  lobes.colour = textureAt(uvAt(v, lambda));
#endif
  return lobes;
}

/// The lobes of the triangle's part in one (turned) column.
Lobes lobesOfColumn(Varying v, LatticeTriangle t, ivec2 column) {
  Lobes lobes = Lobes(1u, v.normal, vec3(1.0));
#if LPV_DIRECTIONS || LPV_TEXTURED
  const ivec3 cell = ivec3(column, 0);
  const dvec2 centre = (dvec2(column) + 0.5lf) * double(kLatticeUnits);
  const Boundary part = boundaryWithin(t, cell, true);
  if (any(greaterThan(part.lower, part.upper))) return lobes;  // nothing in this column: no pair either
  dvec2 corners[4];
  for (int i = 0; i < 4; ++i) {
    corners[i] = barycentric(t, centre, dvec2((i & 1) == 0 ? part.lower.x : part.upper.x, (i & 2) == 0 ? part.lower.y : part.upper.y));
  }
#if LPV_DIRECTIONS
  spreadLobes(v, corners, lobes);
#endif
#if LPV_TEXTURED
  lobes.colour = boxColour(v, barycentric(t, centre, 0.5lf * (part.lower + part.upper)), corners);
#endif
#endif
  return lobes;
}
