// What varies over a triangle: emission direction per vertex (paper 3.2) and radiance factor by texture (3.3). Both are
// looked up by two barycentric coordinates, lambda = (weight of corner b, weight of corner c).
#ifndef LPV_DIRECTIONS
#error "LPV_DIRECTIONS: 0 or 1"
#endif

struct Varying {
  vec3 normal;              // geometric, unit, outward, grid space
  vec3 direction[3];        // unit
  dvec2 uv[3];              // of texels: x = u width - .5
};

#if LPV_DIRECTIONS
layout(std430, binding = kDirections) readonly buffer Directions { float directions[]; };

/// Unit vector, grid space; the normal for a vertex without direction.
vec3 vertexDirection(uint vertex, vec3 normal) {
  const vec3 d = vec3(directions[3u * vertex], directions[3u * vertex + 1u], directions[3u * vertex + 2u]);
  const float size = max(abs(d.x), max(abs(d.y), abs(d.z)));
  if (size == 0.0) return normal;
  const dvec3 moved = (params.gridFromObject * dvec4(dvec3(d / size), 0.0lf)).xyz;
  return vec3(moved / sqrt(dot(moved, moved)));
}
#endif

#if LPV_TEXTURED
layout(std430, binding = kUvs) readonly buffer Uvs { float uvs[]; };

dvec2 vertexUv(uint vertex) { return dvec2(uvs[2u * vertex], uvs[2u * vertex + 1u]); }
#endif

Varying varyingOf(uvec3 corners, vec3 normal) {
  Varying v;
  v.normal = normal;
#if LPV_TEXTURED
  // Whole repeats are left out: far from the first texel there would be no digits left for the distance between two.
  const dvec2 repeats = floor(vertexUv(corners.x));
#endif
  for (int i = 0; i < 3; ++i) {
#if LPV_DIRECTIONS
    v.direction[i] = vertexDirection(corners[i], normal);
#endif
#if LPV_TEXTURED
    v.uv[i] = (vertexUv(corners[i]) - repeats) * dvec2(params.textureSize) - 0.5lf;
#endif
  }
  return v;
}

/// v at unit length, or `otherwise` where v points nowhere.
vec3 unitOr(dvec3 v, vec3 otherwise) {
  const double size = dot(v, v);
  return size > 1e-12lf ? vec3(v / sqrt(size)) : otherwise;
}

vec3 directionAt(Varying v, dvec2 lambda) {
#if LPV_DIRECTIONS
  // Differences first: equal corners stay equal however far outside the triangle lambda lies. In double: what is left
  // where opposite directions nearly cancel still has its digits.
  const dvec3 d = dvec3(v.direction[0]);
  return unitOr(d + lambda.x * (dvec3(v.direction[1]) - d) + lambda.y * (dvec3(v.direction[2]) - d), v.normal);
#else
  return v.normal;
#endif
}

dvec2 uvAt(Varying v, dvec2 lambda) {
  return v.uv[0] + lambda.x * (v.uv[1] - v.uv[0]) + lambda.y * (v.uv[2] - v.uv[0]);
}

/// Barycentric coordinates of a point of the plane of projection, given from the centre of a cell.
dvec2 barycentric(LatticeTriangle t, dvec2 centre, dvec2 p) {
  const dvec2 from = p + centre - t.v0.xy;
  return dvec2(cross2(from, t.v2.xy - t.v0.xy), cross2(t.v1.xy - t.v0.xy, from)) / t.normal.z;
}

#if LPV_FLUX && LPV_OUTLINED
/// A boundary in barycentric coordinates, counter-clockwise there.
Boundary barycentricBoundary(LatticeTriangle t, ivec3 cell, Boundary b) {
  const dvec2 centre = (dvec2(cell.xy) + 0.5lf) * double(kLatticeUnits);
  for (int i = 0; i < kMostPieces; ++i) {
    if (b.pieces[i].xy == b.pieces[i].zw) continue;  // none there: stays zeros
    const dvec4 piece = dvec4(barycentric(t, centre, b.pieces[i].xy), barycentric(t, centre, b.pieces[i].zw));
    b.pieces[i] = t.normal.z < 0.0lf ? turnedRound(piece) : piece;
  }
  return b;
}

Boundary wholeTriangle() {
  Boundary b = noBoundary();
  addPiece(0, dvec4(0.0lf, 0.0lf, 1.0lf, 0.0lf), b);
  addPiece(1, dvec4(1.0lf, 0.0lf, 0.0lf, 1.0lf), b);
  addPiece(2, dvec4(0.0lf, 1.0lf, 0.0lf, 0.0lf), b);
  return b;
}
#endif
