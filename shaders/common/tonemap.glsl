// The published tone curve. The C++ twin is server/scene/tonemap.h; tests/gpu/common/tonemap_test.cpp compares the two.

/// Narkowicz's 2016 fit of the ACES filmic curve, clamped.
vec3 toneCurve(vec3 x) { return clamp(x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14), 0.0, 1.0); }

/// IEC 61966-2-1.
vec3 srgbFromLinear(vec3 x) {
  return mix(1.055 * pow(x, vec3(1.0 / 2.4)) - 0.055, 12.92 * x, lessThanEqual(x, vec3(0.0031308)));
}

/// Radiance to display values 0..1. Beyond 1e4 the curve is flat: cut there, where its squares are still finite.
vec3 displayFromRadiance(vec3 radiance, float exposure) {
  return srgbFromLinear(toneCurve(min(radiance * exposure, 1e4)));
}

/// Rec.709 luminance.
float luminanceOf(vec3 rgb) { return dot(rgb, vec3(0.2126, 0.7152, 0.0722)); }
