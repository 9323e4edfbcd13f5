// Directions in two numbers of 0..1 (Meyer et al. 2010): 16 bits each keep them to 4e-5.

/// n of any length but 0.
vec2 octahedralFromDirection(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  const vec2 folded = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return 0.5 * (n.z >= 0.0 ? n.xy : folded) + 0.5;
}

vec3 unitFromOctahedral(vec2 e) {
  const vec2 f = 2.0 * e - 1.0;
  vec3 n = vec3(f, 1.0 - abs(f.x) - abs(f.y));
  const float t = max(-n.z, 0.0);
  n.xy += vec2(n.x >= 0.0 ? -t : t, n.y >= 0.0 ? -t : t);
  return normalize(n);
}
