// The volume (MATHS.md 3a): SH of incident radiance, L00 = U0 / (1.5 s^2), L1m = -U1m / (1.5 s^2), directions
// towards the light, cut back to phi >= 0 and |D| <= phi. LPV_INJECTED: the injected field as it is, with its colours.
//
// LPV_TEXTURES: into 3D textures for frames; a field of one channel stays one texture, its colour is applied on
// reading, and the groups of lights lie one behind the other along z. LPV_BUFFER: into the buffer that is
// read back (kIncidentVolume).
#include "layout.h"
#include "common/sh.glsl"
#include "common/field.glsl"

#if !defined(LPV_TEXTURES) || !defined(LPV_BUFFER) || !defined(LPV_INJECTED)
#error "LPV_TEXTURES, LPV_BUFFER, LPV_INJECTED: 0 or 1"
#endif
#ifndef LPV_EMITTER_DISTANCE
#error "LPV_EMITTER_DISTANCE: 0, or 1 with LPV_TEXTURES: how near emitters are goes along"
#endif

layout(local_size_x = kFieldGroupX, local_size_y = kFieldGroupY) in;

layout(std140, binding = kParams) uniform Block { VolumeParams params; };
layout(std430, binding = kCounters) buffer CounterBlock { Counters counters; };
layout(binding = kFieldIn) uniform samplerBuffer fieldIn;
#if LPV_TEXTURES
#if LPV_CHANNELS == 1
layout(binding = kIncidentOut, rgba32f) uniform writeonly image3D incident;
#else
layout(binding = kIncidentOut, rgba32f) uniform writeonly image3D incidentRed;
layout(binding = kIncidentOut + 1, rgba32f) uniform writeonly image3D incidentGreen;
layout(binding = kIncidentOut + 2, rgba32f) uniform writeonly image3D incidentBlue;
#endif
#endif
#if LPV_EMITTER_DISTANCE
layout(std430, binding = kEmitterDistanceBuffer) readonly buffer EmitterDistance { float emitterDistance[]; };
layout(binding = kEmitterDistanceOut, r32f) uniform writeonly image3D emitterDistanceOut;
#endif
#if LPV_BUFFER
layout(std430, binding = kIncidentVolume) writeonly buffer IncidentVolume { float volume[]; };
#endif

/// One colour of a cell; `cut` is raised where the moments are not those of real light.
vec4 incidentOf(vec4 u, inout bool cut) {
#if LPV_INJECTED
  return u;
#else
  vec4 c = u * vec4(params.band0Factor, vec3(params.band1Factor));
  if (c.x < 0.0) {
    cut = true;
    return vec4(0.0);
  }
  const float fluence = shFluence(c), flux = length(shVectorIrradiance(c));
  if (flux > fluence) {
    cut = true;
    c.yzw *= fluence / flux;
  }
  return c;
#endif
}

vec4 channelOf(ivec3 cell, int k) {
  return texelFetch(fieldIn, haloIndex(cell, params.dims, params.firstChannel + k));
}

#if LPV_BUFFER
int cells() { return params.dims.x * params.dims.y * params.dims.z; }

void store(ivec3 cell, int colour, vec4 c) {
  const int base = (cellIndex(cell, params.dims) + params.group * cells()) * kVolumeFloats + colour * kCoefficients;
  for (int j = 0; j < kCoefficients; ++j) volume[base + j] = c[j];
}
#endif

void main() {
  const ivec3 cell = ivec3(gl_GlobalInvocationID.xy, params.firstSlice + int(gl_WorkGroupID.z));
  if (cell.x >= params.dims.x || cell.y >= params.dims.y) return;
  const ivec3 texel = cell + ivec3(0, 0, params.group * params.dims.z);
#if LPV_EMITTER_DISTANCE
  if (params.group == 0) imageStore(emitterDistanceOut, cell, vec4(emitterDistance[cellIndex(cell, params.dims)]));
#endif
  bool cut = false;
#if LPV_CHANNELS == 1
  const vec4 c = incidentOf(channelOf(cell, 0), cut);
#if LPV_TEXTURES
  imageStore(incident, texel, c);
#endif
  mat3x4 colours = mat3x4(c * params.palette[0].r, c * params.palette[0].g, c * params.palette[0].b);
#else
  mat3x4 colours = mat3x4(0.0);
  for (int k = 0; k < LPV_CHANNELS; ++k) colours += outerProduct(channelOf(cell, k), params.palette[k].rgb);
  for (int i = 0; i < 3; ++i) colours[i] = incidentOf(colours[i], cut);
#if LPV_TEXTURES
  imageStore(incidentRed, texel, colours[0]);
  imageStore(incidentGreen, texel, colours[1]);
  imageStore(incidentBlue, texel, colours[2]);
#endif
#endif
#if LPV_BUFFER
  for (int i = 0; i < kColours; ++i) store(cell, i, colours[i]);
#endif
  if (cut) atomicAdd(counters.clamped, 1u);
}
