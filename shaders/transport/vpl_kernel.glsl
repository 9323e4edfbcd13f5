// What arrives from one VPL (MATHS.md 3b.4, 3c.3). Every receiver uses this file: the cells of the volume (gather.comp),
// points in the near field (emitter_list.glsl) and probes on the CPU (server/scene/emitter_list.cpp, in double).
// tests/gpu/transport/vpl_kernel_test.cpp compares all three with the derivation in tests/reference/gather.cpp.
//
// Written in what GLSL and C++ have in common: no swizzles, no in and out parameters. Scalar is one number, Vector three,
// Real one number per receiver: LPV_RECEIVERS is 1, or 4. Across is Scalar for four receivers that differ in z only, Real
// with LPV_RECEIVERS_APART. Names with a formula are those of MATHS.md. Grid space: cell units.
#ifndef LPV_RECEIVERS
#error "LPV_RECEIVERS: 1 or 4"
#endif
#ifndef __cplusplus
#define Scalar float
#define Vector vec3
#if LPV_RECEIVERS == 1
#define Real float
#else
#define Real vec4
#endif
#ifdef LPV_RECEIVERS_APART
#define Across Real
#else
#define Across Scalar
#endif
#endif

const Scalar kNearest = 1e-3;         // cells: where the direction towards a VPL is lost
const Scalar kMostInverse = 2.0;      // 1 / r is cut at half a cell of the volume
const Scalar kRegularisation = 2.5;   // the second order is halved at r^2 = 2.5 tr V
const Scalar kLeastHeights = 1e-12;   // cells: instead of a VPL without extent over the horizon

/// A VPL as it stands in the tree's entries (shaders/transport/vpls.glsl), without its area and colour.
struct VplEntry {
  Vector position;     // p
  Vector direction;    // N: area x mean direction of emission
  Scalar spread;       // h: of N.w among what was merged, an area
  Vector variances;    // xx, yy, zz of V, the covariance of where light leaves, cell^2
  Scalar trace;        // tr V
  Vector covariances;  // xy, xz, yz of V
  Scalar mostInverse;  // 1 / r is cut at half a cell of the light
};

/// Of an entry's first four texels.
VplEntry vplEntry(vec4 first, vec4 second, vec4 third, vec4 fourth) {
  return VplEntry(Vector(first.x, first.y, first.z), Vector(second.x, second.y, second.z), second.w,
                  Vector(third.x, third.y, third.z), third.w, Vector(fourth.x, fourth.y, fourth.z), fourth.w);
}

/// V a
Vector covarianceTimes(VplEntry v, Vector a) {
  return Vector(v.variances.x * a.x + v.covariances.x * a.y + v.covariances.y * a.z,
                v.covariances.x * a.x + v.variances.y * a.y + v.covariances.z * a.z,
                v.covariances.y * a.x + v.covariances.z * a.y + v.variances.z * a.z);
}

/// I(t) and sigma = dI/dt: the mean of the positive part of what is even over [t - spread, t + spread]. From both sides
/// I(t) + I(-t).
struct Emission {
  Real intensity;
  Real facingShare;  // sigma
};

Emission emissionTowards(Real t, Scalar spread, bool twoSided) {
  const Real within = clamp(t, -spread, spread);
  if (twoSided) {
    return Emission((within * within + spread * spread) / (2.0 * spread) + max(abs(t) - spread, 0.0), within / spread);
  }
  return Emission((within + spread) * (within + spread) / (4.0 * spread) + max(t - spread, 0.0),
                  (within + spread) / (2.0 * spread));
}

/// From a VPL of unit radiance.
struct Arriving {
  Real fluence;          // phi
  Real x, y, z;          // D, the vector irradiance
  Real inverseDistance;  // 1 / r
};

/// 1 / the minimum distance r^. Cells of the volume are interpolated between, points are not.
Scalar leastDistanceInverse(VplEntry v) {
#if LPV_RECEIVERS == 1
  return v.mostInverse;
#else
  return min(v.mostInverse, kMostInverse);
#endif
}

/// At a receiver from which the VPL's position is at d: the kernel of a flat emitter and g times its second order.
Arriving arrivingFrom(VplEntry v, Across dx, Across dy, Real dz, bool twoSided) {
  const Real inverse = inversesqrt(max(dx * dx + dy * dy + dz * dz, kNearest * kNearest));
  const Real nd = v.direction.x * dx + v.direction.y * dy + v.direction.z * dz;  // N.d
  const Emission emission = emissionTowards(-nd * inverse, v.spread, twoSided);
  const Real cut = min(inverse, leastDistanceInverse(v)), falloff = cut * cut;  // 1 / r^ and 1 / r^^2
  const Real vdx = v.variances.x * dx + v.covariances.x * dy + v.covariances.y * dz;  // V d
  const Real vdy = v.covariances.x * dx + v.variances.y * dy + v.covariances.z * dz;
  const Real vdz = v.covariances.y * dx + v.covariances.z * dy + v.variances.z * dz;
  const Vector vn = covarianceTimes(v, v.direction);                  // V N
  const Real nvd = vn.x * dx + vn.y * dy + vn.z * dz;                 // N.V d
  const Real dvd = falloff * (vdx * dx + vdy * dy + vdz * dz);        // d.V d / r^^2
  const Real nearness = kRegularisation * v.trace * falloff, nearness2 = nearness * nearness;
  const Real g = emission.facingShare * falloff * falloff / (1.0 + nearness2 * nearness2);
  const Real fluence = emission.intensity * falloff + g * cut * (3.0 * nvd + nd * (1.5 * v.trace - 7.5 * dvd));
  const Real alongD =
      emission.intensity * falloff * inverse + g * falloff * (4.0 * nvd + nd * (2.0 * v.trace - 12.0 * dvd));
  const Real alongVd = 4.0 * g * falloff * nd;
  return Arriving(fluence, alongD * dx + alongVd * vdx - g * vn.x, alongD * dy + alongVd * vdy - g * vn.y,
                  alongD * dz + alongVd * vdz - g * vn.z, inverse);
}

#if LPV_RECEIVERS == 1
/// E on a surface with unit normal n, d as above. Where the surface's horizon goes through the VPL's extent, what is
/// above it counts: heights over it are taken to be even over an interval of the VPL's variance. Nothing comes from a VPL
/// that is below it as a whole.
Scalar irradianceFrom(VplEntry v, Vector d, Vector n, bool twoSided) {
  const Arriving light = arrivingFrom(v, d.x, d.y, d.z, twoSided);
  const Vector flux = Vector(light.x, light.y, light.z);
  const Scalar height = dot(n, d);
  const Scalar heights = max(sqrt(max(3.0 * dot(n, covarianceTimes(v, n)), 0.0)), kLeastHeights);
  const Scalar above = emissionTowards(height, heights, false).intensity;
  return sign(above) * max(0.0, dot(n, flux) + length(flux) * light.inverseDistance * (above - height));
}
#elif defined LPV_RECEIVERS_APART
/// The same for four receivers with a normal each.
Real irradianceFrom(VplEntry v, Real dx, Real dy, Real dz, Real nx, Real ny, Real nz, bool twoSided) {
  const Arriving light = arrivingFrom(v, dx, dy, dz, twoSided);
  const Real height = nx * dx + ny * dy + nz * dz;
  const Real variance = v.variances.x * nx * nx + v.variances.y * ny * ny + v.variances.z * nz * nz +
                        2.0 * (v.covariances.x * nx * ny + v.covariances.y * nx * nz + v.covariances.z * ny * nz);
  const Real heights = max(sqrt(max(3.0 * variance, 0.0)), kLeastHeights);
  const Real within = clamp(height, -heights, heights) + heights;
  const Real above = within * within / (4.0 * heights) + max(height - heights, 0.0);
  const Real size = sqrt(light.x * light.x + light.y * light.y + light.z * light.z);
  const Real e = nx * light.x + ny * light.y + nz * light.z + size * light.inverseDistance * (above - height);
  return sign(above) * max(e, 0.0);
}
#endif
