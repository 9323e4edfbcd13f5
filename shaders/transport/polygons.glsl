// Irradiance of polygons of even radiance by the closed form (Lambert; Arvo 1995; MATHS.md 3c), and their solid angle.
#include "common/angles.glsl"

/// The part of E that an edge from p to q of a light's outline gives: the angle it takes times the cosine of its plane.
/// p x (q - p) and q x (q - p) are p x q, but for rounding: edges of a small light that is far away all but cancel, and
/// with p x q what is left of them at 500 times its size is noise.
float edgeIrradiance(vec3 p, vec3 q, vec3 n) {
  const vec3 normal = cross(dot(p, p) < dot(q, q) ? p : q, q - p);
  const float size = length(normal);
  return size > 0.0 ? angleBetween(size, dot(p, q)) * dot(normal, n) / size : 0.0;
}

/// The part of E that an edge of a triangle gives where it is above the horizon of n, and where the outline goes below
/// and comes up again.
void addEdge(vec3 p, vec3 q, vec3 n, inout float sum, inout vec3 leaves, inout vec3 returns) {
  const float hp = dot(p, n), hq = dot(q, n);
  if (hp <= 0.0 && hq <= 0.0) return;
  const vec3 cut = hp * hq < 0.0 ? (p * hq - q * hp) / (hq - hp) : hp <= 0.0 ? p : q;
  if (hp > 0.0 && hq <= 0.0) leaves = cut;
  if (hp <= 0.0 && hq > 0.0) returns = cut;
  sum += edgeIrradiance(hp > 0.0 ? p : cut, hq > 0.0 ? q : cut, n);
}

/// E of unit radiance; corners seen from the receiver. The triangle is cut at the horizon of n: edge by edge, and where
/// the outline goes below and comes up again, one edge along the horizon. No loop: those who look at many triangles
/// count one round for each (kMaxRounds).
float triangleIrradiance(vec3 a, vec3 b, vec3 c, vec3 n, float sides) {
  const float side = dot(cross(b - a, c - a), a);
  if (side == 0.0 || (side > 0.0 && sides < 1.5)) return 0.0;
  vec3 leaves = vec3(0.0), returns = vec3(0.0);
  float sum = 0.0;
  addEdge(a, b, n, sum, leaves, returns);
  addEdge(b, c, n, sum, leaves, returns);
  addEdge(c, a, n, sum, leaves, returns);
  sum += edgeIrradiance(leaves, returns, n);
  return 0.5 * abs(sum);
}

/// The solid angle (Van Oosterom and Strackee 1983) of the side that emits; corners seen from the receiver.
float triangleSolidAngle(vec3 a, vec3 b, vec3 c, float sides) {
  const float side = dot(cross(b - a, c - a), a);
  if (side == 0.0 || (side > 0.0 && sides < 1.5)) return 0.0;
  const float la = length(a), lb = length(b), lc = length(c);
  return 2.0 * atan(abs(side), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
}

/// A direction within a spherical triangle, evenly by solid angle (Arvo 1995, "Stratified sampling of spherical triangles");
/// corners are unit vectors.
vec3 directionWithin(vec3 a, vec3 b, vec3 c, float angle, vec2 u) {
  const vec3 ab = normalize(cross(a, b)), ca = normalize(cross(c, a));
  const float cosine = clamp(-dot(ab, ca), -1.0, 1.0), sine = sqrt(max(1.0 - cosine * cosine, 1e-12));
  const float part = u.x * angle - acos(cosine), s = sin(part), t = cos(part);
  const float p = t - cosine, q = s + sine * dot(a, b);
  const float below = (q * s + p * t) * sine;
  const float along = abs(below) > 1e-12 ? clamp(((q * t - p * s) * cosine - q) / below, -1.0, 1.0) : 1.0;
  const vec3 edge = along * a + sqrt(max(1.0 - along * along, 0.0)) * normalize(c - dot(c, a) * a);
  const float z = 1.0 - u.y * (1.0 - dot(edge, b));
  return z * b + sqrt(max(1.0 - z * z, 0.0)) * normalize(edge - dot(edge, b) * b);
}
