// The lights themselves at the points of a picture that near_field.comp has listed, four to a thread. These are close
// together, and the same ones in every run, so results are the same, too, whatever the order of the list. LPV_SHADOWED:
// E of one pool of lights, which is not put into the picture yet (shadow_rays.comp). LPV_PATCHES: the mean over each
// patch, which may be as large as a light is far.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/receivers.glsl"
#include "transport/emitter_list_four.glsl"

#ifndef LPV_SHADOWED
#error "LPV_SHADOWED: 0 or 1"
#elif LPV_SHADOWED
#include "visibility/shadow_points.glsl"
#else
layout(binding = kNearFieldOut, rgba32f) uniform image2D nearField;  // as in near_field.comp
#endif

layout(local_size_x = kNearFieldGroup) in;

/// Places on surfaces, of pixels or patches.
FourReceivers receivers(uvec4 four) {
  FourReceivers r;
  for (int i = 0; i < 4; ++i) {
    const ivec2 pixel = unpackedPixel(four[i]);
    const vec3 n = receiverNormal(pixel), x = receiverPosition(pixel);
    r.x[i] = x.x;
    r.y[i] = x.y;
    r.z[i] = x.z;
    r.nx[i] = n.x;
    r.ny[i] = n.y;
    r.nz[i] = n.z;
  }
  return r;
}

#if LPV_PATCHES
const int kMostParts = 64;           // three halvings of its edges
const float kEvenEnough = 0.05;      // by how much the mean may change with the last of them
const float kOpeningShare = 0.7;     // of k, beside the middle

/// How far the middle of a part is from that of its triangle: of `parts` alike, a power of 4, which halves of edges make.
vec3 toPart(Patch p, int part, int parts) {
  const vec3 middle = (p.corners[0].xyz + p.corners[1].xyz + p.corners[2].xyz) / 3.0;
  vec3 offset = vec3(0.0);
  float size = 0.5;
  for (; parts > 1; parts /= 4, part /= 4) {
    const int corner = part & 3;  // 3: between the others, and turned
    offset += corner < 3 ? size * (p.corners[corner].xyz - middle) : vec3(0.0);
    size *= corner < 3 ? 0.5 : -0.5;
  }
  return offset;
}

/// `r` moved to a part of each of the four; those that are no triangles stay.
FourReceivers atParts(FourReceivers r, uvec4 four, int part, int parts) {
  for (int i = 0; i < 4; ++i) {
    const Patch p = patches[unpackedPixel(four[i]).x];
    const vec3 offset = p.corners[0].w > 0.0 ? toPart(p, part, parts) : vec3(0.0);
    r.x[i] += offset.x;
    r.y[i] += offset.y;
    r.z[i] += offset.z;
  }
  return r;
}

bool alike(vec4 a, vec4 b) { return all(lessThanEqual(abs(a - b), kEvenEnough * max(a, b))); }

/// The mean over the parts of patches.
FourIrradiances meanOfParts(FourReceivers r, uvec4 four, int parts, inout int rounds) {
  FourIrradiances sum = FourIrradiances(vec4(0.0), vec4(0.0), vec4(0.0));
  for (int part = 0; part < parts; ++part) {
    const FourReceivers at = atParts(r, four, part, parts);
    const FourIrradiances e = directIrradiances(at, shadow.firstLight, shadow.lightsEnd, parts > 1 ? kOpeningShare : 1.0, rounds);
    sum = FourIrradiances(sum.red + e.red, sum.green + e.green, sum.blue + e.blue);
  }
  return FourIrradiances(sum.red / float(parts), sum.green / float(parts), sum.blue / float(parts));
}

/// The mean over the patches of what would come with nothing in the way: of finer and finer parts, until it stands, or
/// until the next ones would take more rounds than a thread has. Lights are looked at in one place, which compilers that
/// inline all functions and unroll counted loops have once: one of them took 22 s.
FourIrradiances sentTo(FourReceivers r, uvec4 four) {
  FourIrradiances mean = FourIrradiances(vec4(-1.0), vec4(-1.0), vec4(-1.0));  // like no other
  int rounds = 0, before = 0;
  for (int parts = 1; parts <= kMostParts && rounds + 4 * (rounds - before) <= kMaxRounds; parts *= 4) {
    before = rounds;
    const FourIrradiances finer = meanOfParts(r, four, parts, rounds);
    const bool even = alike(finer.red, mean.red) && alike(finer.green, mean.green) && alike(finer.blue, mean.blue);
    mean = finer;
    if (even) break;
  }
  return mean;
}
#elif LPV_SHADOWED
FourIrradiances sentTo(FourReceivers r, uvec4 four) {
  int rounds = 0;
  return directIrradiances(r, shadow.firstLight, shadow.lightsEnd, frame.openingShare, rounds);
}
#endif

void main() {
  if (gl_GlobalInvocationID.x >= list.count) return;
  const uvec4 four = points[gl_GlobalInvocationID.x];
  const FourReceivers r = receivers(four);
#if LPV_SHADOWED
  const FourIrradiances e = sentTo(r, four);
  for (int i = 0; i < 4; ++i) {
    begin(4u * gl_GlobalInvocationID.x + uint(i), vec3(e.red[i], e.green[i], e.blue[i]), vec3(0.0), vec3(0.0), 0.0);
  }
#else
  int rounds = 0;
  const FourIrradiances e = directIrradiances(r, 0, lightsInList(), frame.openingShare, rounds);
  for (int i = 0; i < 4; ++i) {
    const ivec2 pixel = unpackedPixel(four[i]);
    imageStore(nearField, pixel, vec4(e.red[i], e.green[i], e.blue[i], imageLoad(nearField, pixel).w));
  }
#endif
}
