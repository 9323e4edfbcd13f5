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

bool isUpper(int sector, int side) { return (sector >> side & 1) != 0; }

/// Of the light at this sine above a border: smoothstep.
vec4 sideShare(bool upper, vec4 sine) {
  const vec4 t = clamp(0.5 + (upper ? 0.5 : -0.5) / kSectorBorder * sine, 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

vec4 shareOfSides(int sector, vec4 first, vec4 second, vec4 third) {
#if LPV_SECTORS != LPV_SECTORS_OCTANTS
  third = kRootHalf * (abs(first) - abs(second));
#endif
  return sideShare(isUpper(sector, 0), first) * sideShare(isUpper(sector, 1), second) *
         sideShare(isUpper(sector, 2), third);
}

/// Of the light from the unit direction (x, y, z).
vec4 sectorShare(int sector, vec4 x, vec4 y, vec4 z) { return shareOfSides(sector, LPV_PERMUTED(x, y, z)); }

/// Whether the share may be above 0 for some direction towards a box; `low` and `high`: its corners, seen from the
/// receiver.
bool sectorReached(int sector, vec3 low, vec3 high) {
  const float distance = length(max(abs(low), abs(high)));  // of the farthest corner
  const vec3 least = vec3(LPV_PERMUTED(low.x, low.y, low.z)), most = vec3(LPV_PERMUTED(high.x, high.y, high.z));
  vec3 above = vec3(isUpper(sector, 0) ? most.x : -least.x, isUpper(sector, 1) ? most.y : -least.y,
                    isUpper(sector, 2) ? most.z : -least.z);
#if LPV_SECTORS != LPV_SECTORS_OCTANTS
  const vec2 farthest = max(abs(least.xy), abs(most.xy)), nearest = max(max(least.xy, -most.xy), 0.0);
  above.z = kRootHalf * (isUpper(sector, 2) ? farthest.x - nearest.y : farthest.y - nearest.x);
#endif
  return all(greaterThanEqual(above, vec3(-kSectorBorder * distance)));
}
