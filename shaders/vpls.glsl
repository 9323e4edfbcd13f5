// Virtual point lights as transport reads them (MATHS.md 3b). A record is a node's header or one of its VPLs, which
// follow it, one per normal bin that holds light.
//   header  (centre, edge) (VPLs, the record after the node and all below it, -, -)
//   VPL     (position, area) (area x direction, spread)  with a texture: (colour, -)
// Grid space: cell units. Colours are shares of the light's brightest texel.
//
// A VPL of flat emitter of area x direction N sends max(0, t), t = N.w, in direction w. Where the merged directions
// differ, the cosine's edge at the horizon is rounded off: (t + sqrt(t^2 + spread^2)) / 2, with the spread that keeps
// the power, pi x area; the first moment is right for any. For all directions alike it is the flat emitter's, for
// directions that cancel an even glow. (MATHS.md 3b.4 has max(0, t) + (area - |N|) / 4: the same power and moment, but
// a quarter of what is missing lights the back too, and the front twice.)
#ifndef LPV_TEXTURED
#error "LPV_TEXTURED: 0 or 1"
#endif

#if LPV_TEXTURED
const int kRecordTexels = 3;
#else
const int kRecordTexels = 2;
#endif

struct Vpl {
  vec3 position;
  float area;
  vec3 direction;  // area x mean direction of emission
  float spread;    // of the directions around their mean, an area
  vec3 colour;
};

/// sqrt(1 + e^2) + e^2 asinh(1 / e) = area / |area x direction|, e = spread / |area x direction|, by Newton's method: the
/// left side is convex and the first guess, its limit for large e, never too small by more than one step.
float spreadOf(float area, vec3 direction) {
  const float size = length(direction);
  if (size <= 1e-6 * area) return 0.5 * area;
  const float missing = area / size - 1.0;
  if (missing <= 1e-6) return 0.0;
  float e = min(sqrt(missing), 0.5 * (missing + 1.0));
  for (int i = 0; i < 6; ++i) {
    const float root = sqrt(1.0 + e * e), slope = 2.0 * e * log((1.0 + root) / e);
    // sqrt(1 + e^2) - 1 without the loss of digits.
    e = max(e + (missing - e * e / (1.0 + root)) / slope - 0.5 * e, 1e-4);
  }
  return e * size;
}
