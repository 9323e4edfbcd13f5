// The lights themselves at the points of a picture that near_field.comp has listed, four to a thread. These are close
// together, and the same ones in every run, so results are the same, too, whatever the order of the list. LPV_SHADOWED:
// E of one pool of lights, which is not put into the picture yet (shadow_rays.comp). LPV_PATCHES, shadowed too: the mean
// over each patch, which may be as large as a light is far; a thread has one.
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

#if LPV_PATCHES
layout(local_size_x = 4 * kNearFieldGroup) in;

const int kMostParts = 64;               // three halvings of its edges
const float kEvenEnough = 0.05;          // by how much the mean may change with the last of them
const float kOpeningShare = 0.7;         // of k
const int kMostRounds = kMaxRounds / 4;  // eight neighbours go different ways through a tree, and llvmpipe counts them all

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

/// Where a patch's parts are: all in one place where it is no triangle, and in its own places where it is parted.
vec3 placeOfPart(Patch p, int part, int parts) {
  if (p.corners[0].w == 0.0) return p.place.xyz;
  if (isParted(p)) return ownPlace(p, vec2((float(part) + 0.5) / float(parts), 0.0));
  return p.place.xyz + toPart(p, part, parts);
}

/// The four parts of the k-th of parts / 4 that a patch is cut into; of a whole triangle the last of them is in its middle.
FourReceivers partsOf(Patch p, int k, int parts) {
  FourReceivers r;
  for (int i = 0; i < 4; ++i) {
    const vec3 x = placeOfPart(p, k + i * (parts / 4), parts);
    r.x[i] = x.x;
    r.y[i] = x.y;
    r.z[i] = x.z;
  }
  r.nx = vec4(p.normal.x);
  r.ny = vec4(p.normal.y);
  r.nz = vec4(p.normal.z);
  return r;
}

bool alike(vec3 a, vec3 b) { return all(lessThanEqual(abs(a - b), kEvenEnough * max(a, b))); }

/// The mean over a patch of what would come with nothing in the way: of finer and finer parts, until it stands, or until
/// the next ones would take more rounds than a thread has. Lights are looked at in one place, which compilers that
/// inline all functions and unroll counted loops have once: one of them took 22 s.
vec3 sentTo(Patch p) {
  vec3 mean = vec3(0.0), finer = vec3(0.0);
  int rounds = 0, before = 0;
  for (int parts = 4, k = 0; k < parts / 4;) {
    const FourIrradiances e = directIrradiances(partsOf(p, k, parts), shadow.firstLight, shadow.lightsEnd, kOpeningShare, rounds);
    if (parts == 4) mean = vec3(e.red.w, e.green.w, e.blue.w);  // at the middle
    finer += vec3(dot(e.red, vec4(1.0)), dot(e.green, vec4(1.0)), dot(e.blue, vec4(1.0))) / float(parts);
    if (++k < parts / 4) continue;
    const bool stands = alike(finer, mean), most = rounds + 4 * (rounds - before) > kMostRounds;
    mean = finer;
    if (stands || most || parts == kMostParts) break;
    before = rounds;
    finer = vec3(0.0);
    parts *= 4;
    k = 0;
  }
  return mean;
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  begin(point, sentTo(patches[receiverOf(points[four][point % 4u]).x]), vec3(0.0), vec3(0.0), 0.0);
}
#else
layout(local_size_x = kNearFieldGroup) in;

/// Places on surfaces, of pixels.
FourReceivers receivers(uvec4 four) {
  FourReceivers r;
  for (int i = 0; i < 4; ++i) {
    const ivec2 pixel = receiverOf(four[i]);
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

void main() {
  if (gl_GlobalInvocationID.x >= list.count) return;
  const uvec4 four = points[gl_GlobalInvocationID.x];
  const FourReceivers r = receivers(four);
  int rounds = 0;
#if LPV_SHADOWED
  const FourIrradiances e = directIrradiances(r, shadow.firstLight, shadow.lightsEnd, frame.openingShare, rounds);
  for (int i = 0; i < 4; ++i) {
    begin(4u * gl_GlobalInvocationID.x + uint(i), vec3(e.red[i], e.green[i], e.blue[i]), vec3(0.0), vec3(0.0), 0.0);
  }
#else
  const FourIrradiances e = directIrradiances(r, 0, lightsInList(), frame.openingShare, rounds);
  for (int i = 0; i < 4; ++i) {
    const ivec2 pixel = receiverOf(four[i]);
    imageStore(nearField, pixel, vec4(e.red[i], e.green[i], e.blue[i], imageLoad(nearField, pixel).w));
  }
#endif
}
#endif
