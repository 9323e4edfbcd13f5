// The constants of Kaplanyan & Dachsbacher's propagation (MATHS.md 3a), each derived from the solid angle of the far
// face seen from a neighbour's centre at distance 1. Lobes leave through faces: I(d) of the source in direction d is
// carried by solid angle O and put back as a clamped cosine lobe about the face's normal with prefactor O / pi.

const float kFarAngle = 0.40066968464624;                              // 4 atan(.25 / (1.5 sqrt 2.75)), sr
const float kSideAngle = (2.0 * kPi / 3.0 - kFarAngle) / 4.0;          // sr
const float kSideForward = 2.0 / sqrt(5.0);                            // of the direction (2m + t) / sqrt 5
const float kSideAcross = 1.0 / sqrt(5.0);

// The unclamped sum over 5 faces as a stencil on (u0; ux, uy, uz).
const float kA00 = kLobe0 * kY0 * (kFarAngle + 4.0 * kSideAngle) / kPi;                 // = 1/6
const float kA01 = kLobe0 * kY1 * (kFarAngle + 4.0 * kSideAngle * kSideForward) / kPi;
const float kA10 = kLobe1 * kY0 * kFarAngle / kPi;
const float kA11 = kLobe1 * kY1 * kFarAngle / kPi;
const float kB = kLobe1 * kY1 * 2.0 * kSideAngle * kSideAcross / kPi;
