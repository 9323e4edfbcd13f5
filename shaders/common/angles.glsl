// Angles by polynomials: built-in arc functions need not be exact enough for irradiance.

/// (t - atan t) / t^3 for t in [0, 1], u = t^2, within 1.2e-7.
float atanDeficit(float u) {
  const float p = ((-0.00386673891 * u + 0.0200267476) * u - 0.0489143215) * u + 0.0800968172;
  return (((p * u - 0.108657591) * u + 0.142570449) * u - 0.199986812) * u + 0.333333231;
}

/// Angle in [0, pi/2] of a vector (c, s), both >= 0 and not both 0.
float angleOf(float s, float c) {
  const float t = min(s, c) / max(s, c);
  const float angle = t - t * t * t * atanDeficit(t * t);
  return s <= c ? angle : 0.5 * kPi - angle;
}

/// Angle in [0, pi] between two vectors of any length, given their cross product's length and their dot product; 0 for
/// a vector of no length.
float angleBetween(float cross_, float dot_) {
  if (max(cross_, abs(dot_)) == 0.0) return 0.0;
  const float angle = angleOf(cross_, abs(dot_));
  return dot_ < 0.0 ? kPi - angle : angle;
}
