// Pixels between those of a lattice, which take what surfaces reflect from its corners around them where these are on their
// plane. Whoever includes this has frame/plane.glsl, params.spacing, the lattice's, and nearField.

/// The corners of a pixel's cell, and where it lies between them, in [0, 1).
struct LatticeCell {
  ivec2 low, high;
  vec2 at;
};

LatticeCell cellOf(ivec2 pixel) {
  const ivec2 low = pixel / params.spacing * params.spacing, off = pixel - low;
  return LatticeCell(low, low + params.spacing * min(off, ivec2(1)), vec2(off) / float(params.spacing));
}

bool isOnLattice(ivec2 pixel) { return pixel % params.spacing == ivec2(0); }

/// Whether E there is that of its cell's corners.
bool liesBetween(ivec2 pixel) {
  if (isOnLattice(pixel)) return false;
  const ivec2 size = imageSize(nearField);
  const LatticeCell cell = cellOf(pixel);
  const vec3 x = positionAt(pixel), n = normalAt(pixel);
  for (int i = 0; i < 4; ++i) {
    const ivec2 corner = ivec2((i & 1) == 0 ? cell.low.x : cell.high.x, (i & 2) == 0 ? cell.low.y : cell.high.y);
    if (!isOnPlane(corner, size, x, n) || imageLoad(nearField, corner).w <= 0.0) return false;
  }
  return true;
}
