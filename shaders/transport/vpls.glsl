// Virtual point lights as transport reads them (MATHS.md 3b). An entry is a node's header or one of its VPLs, which
// follow it, one per normal bin that holds light.
//   header  (centre, size: the edge, kColouredSize times with a texture)
//           (VPLs, the entry after the node and all below it, -, -), in an emitter tree
//           (VPLs, the entry after the node and all below it, triangles of a leaf, their first texel)
//   VPL     (position, area) (area x direction, spread) (covariance xx, yy, zz, their sum)
//           (covariance xy, xz, yz, 1 / the minimum distance) with a texture: (colour, -)
// Grid space of the field: its cell units. Colours are shares of the light's brightest texel. The light was voxelized in
// cells of its own; the minimum distance is half of their edge.
//
// What a VPL sends in direction w. A flat emitter of area x direction N sends max(0, t), t = N.w. Where directions were
// merged, t is the mean of a distribution; taken as even over [t - spread, t + spread], its positive part is
//   (t + spread)^2 / (4 spread) between -spread and spread, 0 below, t above.
// With spreadOf() that has the power, pi x area, and the first moment of what was merged. (MATHS.md 3b.4 has max(0, t) +
// (area - |N|) / 4: the same power and moment, but what faces the receiver alone is lit twice, and the back at all.)
//
// Where it sends it from. Merged emitters are spread about their position; the covariance of positions is of where light
// leaves, cell^2. What arrives is expanded about the position up to second order (MATHS.md 3b.2), which is what makes
// nodes usable from near; the series is damped where it does not converge, within about twice the square root of that.
#ifndef LPV_TEXTURED
#error "LPV_TEXTURED: 0 or 1"
#endif

#if LPV_TEXTURED
const int kEntryTexels = kTexturedEntryTexels;
#else
const int kEntryTexels = kPlainEntryTexels;
#endif

struct Vpl {
  vec3 position;
  float area;
  vec3 direction;  // area x mean direction of emission
  float spread;    // of N.w among what was merged, an area
  mat3 positionCovariance;  // of where it emits, cell^2
  vec3 colour;
};

/// The spread that keeps the power: with n = |area x direction|, n + spread^2 / (3 n) = area while the spread is no
/// larger than n, else n^2 / (3 spread) + spread = area.
float spreadOf(float area, vec3 direction) {
  const float n = length(direction), missing = max(area - n, 0.0);
  if (missing <= 1e-6 * area) return max(1e-6 * area, 1e-30);
  if (3.0 * area <= 4.0 * n) return sqrt(3.0 * n * missing);
  return 0.5 * (area + sqrt(max(area * area - 4.0 / 3.0 * n * n, 0.0)));
}

/// Of what is in one cell and taken for a flat square.
mat3 covarianceInCell(float area, vec3 direction) {
  const vec3 n = direction / max(area, 1e-30);
  return min(area, 1.0) / 12.0 * (mat3(1.0) - outerProduct(n, n));
}
