// Patches of the surfaces that reflect light (server/scene/patches.h), grid space.

struct Patch {
  vec4 place;   // position, area
  vec4 normal;  // of the side that it is on
  vec4 albedo;
  vec4 direct;  // E in W/m^2 from the lights
  vec4 arriving[2];  // the same with what patches reflect, by the parity of bounces
  vec4 corners[3];  // counter-clockwise seen from the side that it is on; w: 1 where it is a triangle, 0 where it stands
                    // for several
};

layout(std430, binding = kPatches) buffer Patches { Patch patches[]; };

/// E at x with normal n from a patch of unit radiance with nothing between: that of a disc (Wallace, Elmquist and Haines
/// 1989, "A ray tracing algorithm for progressive radiosity"), which stays finite beside an edge.
float patchWeight(Patch from, vec3 x, vec3 n) {
  const vec3 d = from.place.xyz - x;
  const float r2 = dot(d, d);
  return from.place.w * max(-dot(from.normal.xyz, d), 0.0) * max(dot(n, d), 0.0) /
         max(r2 * (r2 + from.place.w * 0.3183098862), 1e-12);
}

/// A share per colour in ten bits each.
uint packedShare(vec3 share) {
  const uvec3 s = uvec3(share * 1023.0 + 0.5);
  return s.r | s.g << 10 | s.b << 20;
}
vec3 unpackedShare(uint share) { return vec3(share & 1023u, (share >> 10) & 1023u, share >> 20) / 1023.0; }
