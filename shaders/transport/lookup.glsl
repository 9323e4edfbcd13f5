// Irradiance from the volume (MATHS.md 4). The C++ twin is irradianceAt in server/scene/volume.h;
// tests/gpu/transport/lookup_test.cpp compares the two. Light groups lie above one another in the same textures: group g has
// slices [g dims.z, (g + 1) dims.z).

#include "common/angles.glsl"

#ifndef LPV_LOOKUP
#error "LPV_LOOKUP: LPV_LOOKUP_SH2, _CAP or _NEAREST (shaders/layout.h)"
#elif LPV_LOOKUP < LPV_LOOKUP_SH2 || LPV_LOOKUP > LPV_LOOKUP_NEAREST
#error "LPV_LOOKUP: no such value in shaders/layout.h"
#endif

#ifndef LPV_GROUPS
#define LPV_GROUPS 1
#endif

#if LPV_CHANNELS == 1
layout(binding = kIncident) uniform sampler3D incident;
#else
layout(binding = kIncident) uniform sampler3D incidentRed;
layout(binding = kIncident + 1) uniform sampler3D incidentGreen;
layout(binding = kIncident + 2) uniform sampler3D incidentBlue;
#endif

#if !LPV_EXACT_FILTER
vec4 alongX(sampler3D volume, ivec2 x, int y, int z, float share) {
  return mix(texelFetch(volume, ivec3(x.x, y, z), 0), texelFetch(volume, ivec3(x.y, y, z), 0), share);
}

/// What a filter with float weights gives. GPUs' own have weights of 8 bits: pixels and probes would be a thousandth apart.
vec4 between(sampler3D volume, int firstLayer, vec3 at, ivec3 dims) {
  const ivec3 low = ivec3(at), high = min(low + 1, dims - 1);
  const vec3 share = at - vec3(low);
  const ivec2 x = ivec2(low.x, high.x), z = ivec2(low.z, high.z) + firstLayer;
  return mix(mix(alongX(volume, x, low.y, z.x, share.x), alongX(volume, x, high.y, z.x, share.x), share.y),
             mix(alongX(volume, x, low.y, z.y, share.x), alongX(volume, x, high.y, z.y, share.x), share.y), share.z);
}
#endif

/// SH of one colour of a group at a grid position; clamps to the group's outermost cell centres.
vec4 incidentAt(sampler3D volume, int group, vec3 gridPosition, ivec3 dims) {
#if LPV_LOOKUP == LPV_LOOKUP_NEAREST
  const ivec3 cell = clamp(ivec3(floor(gridPosition)), ivec3(0), dims - 1);
  return texelFetch(volume, ivec3(cell.xy, cell.z + group * dims.z), 0);
#elif LPV_EXACT_FILTER
  const float z = clamp(gridPosition.z, 0.5, float(dims.z) - 0.5) + float(group * dims.z);
  return textureLod(volume, vec3(gridPosition.xy, z) / vec3(dims.xy, LPV_GROUPS * dims.z), 0.0);
#else
  return between(volume, group * dims.z, clamp(gridPosition - 0.5, vec3(0.0), vec3(dims - 1)), dims);
#endif
}

/// SH2: E = phi/4 + D.n/2, at least 0.
float irradianceSh2(vec4 c, vec3 n) {
  return max(0.0, 0.25 * shFluence(c) + 0.5 * dot(shVectorIrradiance(c), n));
}

/// (atan2(q sin a, cos a) - q sin a cos a) / sin^2 a. For a small cap the two terms agree in nearly all digits; there
/// it is t - (t - atan t) / sin^2 a with t = q tan a, and (t - atan t) / sin^2 a = t q^2 deficit(t^2) / cos^2 a.
float capSegment(float q, float sine, float cosine) {
  if (q * sine > cosine) return (angleOf(q * sine, cosine) - q * sine * cosine) / (sine * sine);
  const float t = q * sine / cosine;
  const float s = q / cosine;
  return t - t * s * s * atanDeficit(t * t);
}

/// What a cap that the horizon cuts gives beyond D max(0, cos tilt), as a share of |D|: see shareAcrossHorizon in
/// server/scene/volume.cpp.
float shareAcrossHorizon(float sine2, float cosine, float cosTilt) {
  if (sine2 < 1e-6 || cosTilt * cosTilt >= sine2) return 0.0;
  const float sine = sqrt(sine2);
  const float m = min(1.0, abs(cosTilt) / sine);
  const float q = sqrt((1.0 - m) * (1.0 + m));
  if (q == 0.0) return 0.0;
  return max(0.0, capSegment(q, sine, cosine) - abs(cosTilt) * angleOf(q, m * cosine)) / kPi;
}

/// CAP: E of the uniform cap of light about D with the same phi and |D|; SH2 where |D| < phi/2.
float irradianceCap(vec4 c, vec3 n) {
  const float phi = shFluence(c);
  if (!(phi > 0.0)) return 0.0;
  const vec3 d = shVectorIrradiance(c);
  const float size = length(d);
  if (size < 0.5 * phi) return irradianceSh2(c, n);
  const float along = dot(d, n);
  const float rest = (phi - size) / phi;  // 1 - rho; below 0: as 0, a point
  return max(0.0, along) + size * shareAcrossHorizon(4.0 * (1.0 - rest) * rest, 1.0 - 2.0 * rest, along / size);
}

float irradianceOf(vec4 c, vec3 n) {
#if LPV_LOOKUP == LPV_LOOKUP_CAP
  return irradianceCap(c, n);
#else
  return irradianceSh2(c, n);
#endif
}

/// E in W/m^2 of one group.
vec3 groupIrradianceAt(int group, vec3 gridPosition, vec3 n, ivec3 dims, vec3 unit) {
#if LPV_CHANNELS == 1
  return unit * irradianceOf(incidentAt(incident, group, gridPosition, dims), n);
#else
  return vec3(irradianceOf(incidentAt(incidentRed, group, gridPosition, dims), n),
              irradianceOf(incidentAt(incidentGreen, group, gridPosition, dims), n),
              irradianceOf(incidentAt(incidentBlue, group, gridPosition, dims), n));
#endif
}

/// E in W/m^2 of all groups at a grid position on a surface with unit normal n; 0 further than half a cell outside the
/// grid. `dims`: of one group. `unit`: radiance of the channel of a monochrome volume.
vec3 irradianceAt(vec3 gridPosition, vec3 n, ivec3 dims, vec3 unit) {
  if (any(lessThan(gridPosition, vec3(-0.5))) || any(greaterThan(gridPosition, vec3(dims) + 0.5))) return vec3(0.0);
  vec3 sum = vec3(0.0);
  for (int group = 0; group < LPV_GROUPS; ++group) sum += groupIrradianceAt(group, gridPosition, n, dims, unit);
  return sum;
}
