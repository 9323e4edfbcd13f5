// Haze that fills a box (MATHS.md 3g), by the header of what shadow rays can meet (visibility/occluders.glsl). Grid space.

layout(binding = kOccluders) uniform usamplerBuffer occluders;

float hazeExtinction() { return uintBitsToFloat(texelFetch(occluders, 1).w); }

/// The part of a segment, 0..1, that lies in the haze; none: it ends before it begins.
vec2 partInHaze(vec3 from, vec3 way) {
  const vec3 lower = uintBitsToFloat(texelFetch(occluders, 1).xyz), upper = uintBitsToFloat(texelFetch(occluders, 2).xyz);
  const vec3 along = mix(way, vec3(1e-20), lessThan(abs(way), vec3(1e-20)));
  const vec3 a = (lower - from) / along, b = (upper - from) / along, near = min(a, b), far = max(a, b);
  return vec2(max(max(near.x, near.y), max(near.z, 0.0)), min(min(far.x, far.y), min(far.z, 1.0)));
}

/// What light keeps between two points.
float throughHaze(vec3 from, vec3 to) {
  const vec2 part = partInHaze(from, to - from);
  return exp(-hazeExtinction() * max(part.y - part.x, 0.0) * length(to - from));
}
