// Virtual point lights as transport reads them (MATHS.md 3b). A record is a node's header or one of its VPLs, which
// follow it, one per normal bin that holds light.
//   header  (centre, edge) (VPLs, the record after the node and all below it, -, -)
//   VPL     (position, area) (area x direction, (area - |area x direction|) / 4)  with a texture: (colour, -)
// Grid space: cell units. Colours are shares of the light's brightest texel.
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
  float rest;      // what closes the sum of directions: emitted evenly all around
  vec3 colour;
};

float restOf(float area, vec3 direction) { return 0.25 * max(0.0, area - length(direction)); }
