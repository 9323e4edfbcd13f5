#pragma once
// The published tone curve, a second time (Narkowicz 2016; IEC 61966-2-1).

#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace lpv::reference {

/// Radiance times 2^ev to display-linear 0..1: (2.51 x^2 + 0.03 x) / (2.43 x^2 + 0.59 x + 0.14), cut to 0..1.
double curve(double x);
/// Display-linear to sRGB, both 0..1.
double encodeSrgb(double linear);
/// The inverse, by bisection on encodeSrgb: shares no constant with the product's decoder.
double decodeSrgb(double coded);

/// Radiance to 8-bit sRGB, nearest.
glm::u8vec3 displayOf(const glm::dvec3& radiance, double ev);
std::vector<glm::u8vec3> displayOf(const std::vector<glm::dvec3>& radiance, double ev);

}  // namespace lpv::reference
