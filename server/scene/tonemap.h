#pragma once
// The published tone curve of live frames and PNG/JPEG stills. The GLSL twin is shaders/common/tonemap.glsl.

#include <cstdint>
#include <glm/glm.hpp>

namespace lpv {

/// Linear radiance (already multiplied by 2^ev) to display-linear 0..1, per channel: x (2.51 x + 0.03) /
/// (x (2.43 x + 0.59) + 0.14), clamped: Narkowicz's 2016 fit of the ACES filmic curve.
double toneCurve(double x);

/// Display-linear 0..1 to the sRGB transfer function, 0..1 (IEC 61966-2-1).
double srgbFromLinear(double x);
double linearFromSrgb(double x);

/// Radiance to 8-bit sRGB: round(255 srgb(curve(c 2^ev))).
glm::u8vec3 displayFromRadiance(const glm::dvec3& radiance, double ev);

/// Automatic exposure: the stops that bring the picture's mean lightness (the mean cube root of luminance, weights
/// .2126 .7152 .0722, over pixels that show a surface) to that of this display-linear value before the curve. Cube
/// roots (CIE lightness) let black corners count as black: a logarithm would let them overexpose the rest.
inline constexpr double kAutoExposureKey = 0.18;

}  // namespace lpv
