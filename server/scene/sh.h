#pragma once
// Real, orthonormal, 2-band spherical harmonics, without the Condon-Shortley sign (MATHS.md 1).
// Y00 = 1/(2 sqrt pi); (Y1-1, Y10, Y11) = sqrt(3/(4 pi)) (y, z, x). Order of coefficients, on the wire, in files
// and in shaders: (L00, L1-1, L10, L11). The GLSL twin is shaders/common/sh.glsl; tests/gpu compares the two.

#include <glm/glm.hpp>

namespace lpv::sh {

inline constexpr double kPi = 3.14159265358979323846;
inline constexpr double kY0 = 0.28209479177387814347;  // 1 / (2 sqrt(pi))
inline constexpr double kY1 = 0.48860251190291992159;  // sqrt(3 / (4 pi))
/// Clamped cosine lobe about n, projected on 2 bands (Ramamoorthi & Hanrahan 2001): c0 on L00, c1 n on band 1.
inline constexpr double kLobe0 = 0.88622692545275801365;  // sqrt(pi) / 2
inline constexpr double kLobe1 = 1.02332670794648848847;  // sqrt(pi / 3)

/// Four coefficients (L00, L1-1, L10, L11) of one colour.
using Coefficients = glm::dvec4;

/// The basis evaluated in unit direction w.
inline Coefficients basis(const glm::dvec3& w) { return {kY0, kY1 * w.y, kY1 * w.z, kY1 * w.x}; }

/// Projection of max(0, dot(n, w)), n a unit vector.
inline Coefficients lobe(const glm::dvec3& n) { return {kLobe0, kLobe1 * n.y, kLobe1 * n.z, kLobe1 * n.x}; }

/// Band 1 as a vector: (x, y, z) of (L11, L1-1, L10).
inline glm::dvec3 band1(const Coefficients& c) { return {c.w, c.y, c.z}; }

/// Coefficients from band 0 and band 1 as a vector (x, y, z).
inline Coefficients fromBands(double band0, const glm::dvec3& v) { return {band0, v.y, v.z, v.x}; }

/// Fluence phi = integral of L over all directions, W/m^2, from SH of incident radiance.
inline double fluence(const Coefficients& incident) { return incident.x / kY0; }

/// Vector irradiance D = integral of L w over all directions, W/m^2, from SH of incident radiance.
inline glm::dvec3 vectorIrradiance(const Coefficients& incident) { return band1(incident) / kY1; }

}  // namespace lpv::sh
