// Layers by the direction that light comes from (MATHS.md 4): what share of the light from a direction is in the layer
// of a sector. The C++ twin is server/lpv/transport/sectors.cpp.
//
// A sector is told by three sides, bits 0, 1 and 2 of its number: of the first axis, of the second, and of the third
// (octants) or whether the first axis is nearer than the second (45 degrees each about the third). Light beside a border
// is shared, so that a light that crosses one does not jump from layer to layer.

#if LPV_SECTORS == LPV_SECTORS_AROUND_X
#define LPV_PERMUTED(x, y, z) y, z, x
#elif LPV_SECTORS == LPV_SECTORS_AROUND_Y
#define LPV_PERMUTED(x, y, z) z, x, y
#else
#define LPV_PERMUTED(x, y, z) x, y, z
#endif

const float kRootHalf = 0.70710678;

/// Of the light at this sine above a border, what is above: smoothstep.
vec4 upperShare(vec4 sine) {
  const vec4 t = clamp(0.5 + 0.5 / kSectorBorder * sine, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

vec4[kSectors] sharesOfSides(vec4 first, vec4 second, vec4 third) {
#if LPV_SECTORS != LPV_SECTORS_OCTANTS
  third = kRootHalf * (abs(first) - abs(second));
#endif
  const vec4 x = upperShare(first), y = upperShare(second), z = upperShare(third);
  const vec4 both = x * y, onlyX = x - both, onlyY = y - both, none = 1.0 - x - onlyY;
  return vec4[](none - z * none, onlyX - z * onlyX, onlyY - z * onlyY, both - z * both,  //
                z * none, z * onlyX, z * onlyY, z * both);
}

/// Per sector, of the light from the unit direction (x, y, z).
vec4[kSectors] sectorShares(vec4 x, vec4 y, vec4 z) { return sharesOfSides(LPV_PERMUTED(x, y, z)); }
