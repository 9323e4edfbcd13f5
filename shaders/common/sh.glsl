// Real, orthonormal, 2-band spherical harmonics, order (L00, L1-1, L10, L11) (MATHS.md 1). The C++ twin is
// server/scene/sh.h; tests/gpu/common/sh_test.cpp compares the two.

const float kPi = 3.14159265358979323846;
const float kY0 = 0.28209479177387814347;    // 1 / (2 sqrt(pi))
const float kY1 = 0.48860251190291992159;    // sqrt(3 / (4 pi))
const float kLobe0 = 0.88622692545275801365; // sqrt(pi) / 2
const float kLobe1 = 1.02332670794648848847; // sqrt(pi / 3)

/// The basis in unit direction w.
vec4 shBasis(vec3 w) { return vec4(kY0, kY1 * w.yzx); }

/// Projection of max(0, dot(n, w)), n a unit vector (Ramamoorthi & Hanrahan 2001).
vec4 shLobe(vec3 n) { return vec4(kLobe0, kLobe1 * n.yzx); }

/// Band 1 as a vector (x, y, z).
vec3 shBand1(vec4 c) { return c.wyz; }

float shFluence(vec4 incident) { return incident.x / kY0; }
vec3 shVectorIrradiance(vec4 incident) { return shBand1(incident) / kY1; }
