// Patches of the surfaces that reflect light (server/scene/patches.h), grid space.
#include "visibility/patch_weight.glsl"

struct Patch {
  vec4 place;   // position, area
  vec4 normal;  // of the side that it is on; w: of a patch with pieces the first of these
  vec4 albedo;  // w: how many
  vec4 direct;  // E in W/m^2 from the lights
  vec4 arriving[2];  // the same with what patches reflect, by the parity of bounces; of a piece: what others
                     // reflect to it; the second: what of that pieces do, where they are asked again
  vec4 corners[3];  // counter-clockwise seen from the side that it is on; w: 1 where it is a triangle, 0 where it stands
                    // for several; of the second -1 where these have pieces of their own (Folds), of the third then the
                    // square of how far it is from where they are looked for
  float wanted;     // of what patches exchange (transport/patch_balance.comp): what this one gets from all; of a piece: what those
                    // of its patch up to it send together
  float scale[2];   // of its row and column, by the parity of turns
  float of;  // of a piece, which follow the patches: the patch that stands for it; of a patch: what it would get from
             // all if each sent 1, by rays, then by how much more of the others' light comes to it than they account for
};

layout(std430, binding = kPatches) buffer Patches { Patch patches[]; };

/// A place on one that is a triangle; u in [0, 1)^2.
vec3 placeOn(Patch p, vec2 u) {
  if (u.x + u.y > 1.0) u = 1.0 - u;
  return p.corners[0].xyz + u.x * (p.corners[1].xyz - p.corners[0].xyz) + u.y * (p.corners[2].xyz - p.corners[0].xyz);
}

/// A share per colour in ten bits each.
uint packedShare(vec3 share) {
  const uvec3 s = uvec3(share * 1023.0 + 0.5);
  return s.r | s.g << 10 | s.b << 20;
}
vec3 unpackedShare(uint share) { return vec3(share & 1023u, (share >> 10) & 1023u, share >> 20) / 1023.0; }
