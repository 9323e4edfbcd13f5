// What a patch of a surface sends.

// By the square of the distance over its area: nearer ones are taken as the triangles that they are; still nearer, pixels
// ask each by a ray of its own.
const float kNearPatch = 9.0;
const float kAskedPatch = 2.0;

/// patchWeight over the area. Two divisions: they take most of the time on llvmpipe.
float patchWeightPerArea(vec3 d, float area, vec3 normal, vec3 n) {
  const float r2 = max(dot(d, d), 1e-12), size = 0.44 * area, p = dot(n, d), q = min(dot(normal, d), 0.0);
  const float nearer = 1.0 / r2, further = 1.0 / (r2 + size);
  const float second = size * further * (dot(n, normal) * q + 2.0 * p - 3.0 * p * q * q * nearer);
  return p > 0.0 ? -q * max(p + second, 0.0) * nearer * further : 0.0;
}

/// E with normal n from a patch of unit radiance, seen at d, with nothing between: to second order in its size, which is
/// .44 times its area (four times the variance along each axis of its plane: a right triangle's). Finite beside it.
float patchWeight(vec3 d, float area, vec3 normal, vec3 n) { return area * patchWeightPerArea(d, area, normal, n); }
