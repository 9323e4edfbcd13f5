// Irradiance from the volume (MATHS.md 4). The C++ twin is irradianceAt in server/scene/volume.h; tests/gpu/lookup_test.cpp
// compares the two.

#ifndef LPV_NEAREST
#error "LPV_NEAREST: 0 (trilinear) or 1"
#endif

#if LPV_CHANNELS == 1
layout(binding = kIncident) uniform sampler3D incident;
#else
layout(binding = kIncident) uniform sampler3D incidentRed;
layout(binding = kIncident + 1) uniform sampler3D incidentGreen;
layout(binding = kIncident + 2) uniform sampler3D incidentBlue;
#endif

/// SH of one colour at a grid position; clamps to the outermost cell centres.
vec4 incidentAt(sampler3D volume, vec3 gridPosition, ivec3 dims) {
#if LPV_NEAREST
  return texelFetch(volume, clamp(ivec3(floor(gridPosition)), ivec3(0), dims - 1), 0);
#else
  return textureLod(volume, gridPosition / vec3(dims), 0.0);
#endif
}

/// SH2: E = phi/4 + D.n/2, at least 0.
float irradianceSh2(vec4 c, vec3 n) {
  return max(0.0, 0.25 * shFluence(c) + 0.5 * dot(shVectorIrradiance(c), n));
}

/// E in W/m^2 at a grid position on a surface with unit normal n; 0 further than half a cell outside the grid. `unit`:
/// radiance of the channel of a monochrome volume.
vec3 irradianceAt(vec3 gridPosition, vec3 n, ivec3 dims, vec3 unit) {
  if (any(lessThan(gridPosition, vec3(-0.5))) || any(greaterThan(gridPosition, vec3(dims) + 0.5))) return vec3(0.0);
#if LPV_CHANNELS == 1
  return unit * irradianceSh2(incidentAt(incident, gridPosition, dims), n);
#else
  return vec3(irradianceSh2(incidentAt(incidentRed, gridPosition, dims), n),
              irradianceSh2(incidentAt(incidentGreen, gridPosition, dims), n),
              irradianceSh2(incidentAt(incidentBlue, gridPosition, dims), n));
#endif
}
