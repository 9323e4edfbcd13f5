// Where the volume is read and where the lights themselves (MATHS.md 3c).

layout(binding = kEmitterDistance) uniform sampler3D emitterDistance;

/// Weight of the volume's irradiance at a grid position. As in server/scene/emitter_list.h.
float farFromEmitters(vec3 p, ivec3 cells) {
  const vec3 dims = vec3(cells);
  if (any(lessThan(p, vec3(0.5))) || any(greaterThan(p, dims - 0.5))) return 0.0;
  return smoothstep(kNearFieldBegin, kNearFieldEnd, textureLod(emitterDistance, p / dims, 0.0).x);
}
