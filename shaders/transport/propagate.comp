// One iteration of propagation over a box of cells (K&D 2010; MATHS.md 3a), per channel: every cell gathers from its
// six neighbours; outside the grid there is nothing. Coefficients are in directions of travel.
//
// Unclamped, the sum of the injected field u and its n steps is S_n = u + A S_(n-1): one field, no accumulator.
// LPV_CLAMP_FACES, K&D's clamp of face intensities at 0, is not linear: the steps and their sum are kept apart.
#include "layout.h"
#include "common/sh.glsl"
#include "common/field.glsl"
#include "transport/stencil.glsl"

#ifndef LPV_CLAMP_FACES
#error "LPV_CLAMP_FACES: 0 or 1"
#endif

layout(local_size_x = kFieldGroupX, local_size_y = kFieldGroupY) in;

layout(std140, binding = kParams) uniform Block { PropagateParams params; };
// Reads go through texture buffers: 2-3 times faster than storage reads on llvmpipe, no slower on hardware.
layout(binding = kFieldIn) uniform samplerBuffer fieldIn;
layout(std430, binding = kFieldOut) writeonly buffer FieldOut { vec4 fieldOut[]; };
#if LPV_CLAMP_FACES
layout(std430, binding = kFieldSum) buffer FieldSum { vec4 fieldSum[]; };
#else
layout(binding = kFieldSource) uniform samplerBuffer fieldSource;
#endif

#if LPV_CLAMP_FACES

/// What arrives from the neighbour in direction -m through the five faces it can see, each cut at 0.
vec4 arriving(vec4 u, vec3 m, vec3 s, vec3 t) {
  vec4 sum = max(0.0, dot(u, shBasis(m))) * kFarAngle * shLobe(m);
  sum += max(0.0, dot(u, shBasis(m * kSideForward + s * kSideAcross))) * kSideAngle * shLobe(s);
  sum += max(0.0, dot(u, shBasis(m * kSideForward - s * kSideAcross))) * kSideAngle * shLobe(-s);
  sum += max(0.0, dot(u, shBasis(m * kSideForward + t * kSideAcross))) * kSideAngle * shLobe(t);
  sum += max(0.0, dot(u, shBasis(m * kSideForward - t * kSideAcross))) * kSideAngle * shLobe(-t);
  return sum / kPi;
}

vec4 gathered(vec4 xm, vec4 xp, vec4 ym, vec4 yp, vec4 zm, vec4 zp) {
  const vec3 x = vec3(1, 0, 0), y = vec3(0, 1, 0), z = vec3(0, 0, 1);
  return arriving(xm, x, y, z) + arriving(xp, -x, y, z) + arriving(ym, y, z, x) + arriving(yp, -y, z, x) +
         arriving(zm, z, x, y) + arriving(zp, -z, x, y);
}

#else

// Components: x band 0; w, y, z the x, y, z of band 1.
vec4 gathered(vec4 xm, vec4 xp, vec4 ym, vec4 yp, vec4 zm, vec4 zp) {
  const vec4 x = xm + xp, y = ym + yp, z = zm + zp;
  vec4 r;
  r.x = kA00 * (x.x + y.x + z.x) + kA01 * (xm.w - xp.w + ym.y - yp.y + zm.z - zp.z);
  r.w = kA10 * (xm.x - xp.x) + kA11 * x.w + kB * (y.w + z.w);
  r.y = kA10 * (ym.x - yp.x) + kA11 * y.y + kB * (x.y + z.y);
  r.z = kA10 * (zm.x - zp.x) + kA11 * z.z + kB * (x.z + y.z);
  return r;
}

#endif

void main() {
  // Channels lie side by side along the dispatch's y, each over the same box.
  const int channel = int(gl_WorkGroupID.y) / params.groupsPerChannel;
  const int groupY = int(gl_WorkGroupID.y) % params.groupsPerChannel;
  ivec3 cell = params.lower + ivec3(int(gl_GlobalInvocationID.x), groupY * kFieldGroupY + int(gl_LocalInvocationID.y),
                                        int(gl_WorkGroupID.z) * kFieldMarch);
  if (cell.x >= params.upper.x || cell.y >= params.upper.y) return;
  const ivec3 dims = params.dims;
  const int row = dims.x + 2, slab = row * (dims.y + 2);
  int i = haloIndex(cell, dims, channel);
  vec4 behind = texelFetch(fieldIn, i - slab), here = texelFetch(fieldIn, i);
  for (const int end = min(cell.z + kFieldMarch, params.upper.z); cell.z < end; ++cell.z, i += slab) {
    const vec4 ahead = texelFetch(fieldIn, i + slab);
    vec4 value = gathered(texelFetch(fieldIn, i - 1), texelFetch(fieldIn, i + 1), texelFetch(fieldIn, i - row),
                          texelFetch(fieldIn, i + row), behind, ahead);
#if LPV_CLAMP_FACES
    fieldSum[i] += value;
#else
    value += texelFetch(fieldSource, i);
#endif
    fieldOut[i] = value;
    behind = here;
    here = ahead;
  }
}
