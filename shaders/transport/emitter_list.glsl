// DIRECT (MATHS.md 3c): a receiver looks at the lights themselves, without a grid between: few polygons by the closed
// form (Lambert; Arvo 1995), more through the tree over their triangles, everything else as VPLs through the tree of its
// cells. The C++ twin is server/scene/emitter_list.h; tests/gpu/transport/emitter_list_test.cpp compares the two.
//
// Texels: (lights, k, lights looked at, 0); per light (radiance rgb, what it is looked at as: kAsPolygons, ..) and (first texel,
// triangles or entries, sides that emit, texels of an entry); per light that receivers look at wherever they are (its
// number, the share of it, 0, 0); then per light
//   polygons       triangles of three corners each, counter-clockwise seen from the front, grid space
//   VPLs           the entries of shaders/transport/vpls.glsl, grid space
//   emitter tree   three rows of the matrix from grid space to the tree's, which turns, moves and scales alike along all
//                  axes; then, in the tree's space, its entries and the triangles of its leaves (server/scene/emitter_tree.h)
#include "layout.h"
#include "transport/polygons.glsl"
#define LPV_RECEIVERS 1
#include "transport/vpl_kernel.glsl"

layout(binding = kDirect) uniform samplerBuffer direct;

float polygonIrradiance(int first, int triangles, vec3 x, vec3 n, float sides) {
  float sum = 0.0;
  for (int i = 0; i < triangles; ++i) {
    const int at = first + 3 * i;
    sum += triangleIrradiance(texelFetch(direct, at).xyz - x, texelFetch(direct, at + 1).xyz - x,
                              texelFetch(direct, at + 2).xyz - x, n, sides);
  }
  return sum;
}

/// The rows of an emitter tree's matrix.
struct TreeSpace {
  vec4 rows[3];
};

TreeSpace treeSpace(int at) {
  return TreeSpace(vec4[3](texelFetch(direct, at), texelFetch(direct, at + 1), texelFetch(direct, at + 2)));
}
vec3 positionIn(TreeSpace s, vec3 x) {
  const vec4 p = vec4(x, 1.0);
  return vec3(dot(s.rows[0], p), dot(s.rows[1], p), dot(s.rows[2], p));
}
vec3 normalIn(TreeSpace s, vec3 n) {
  return vec3(dot(s.rows[0].xyz, n), dot(s.rows[1].xyz, n), dot(s.rows[2].xyz, n)) / length(s.rows[0].xyz);
}

vec3 vplIrradiance(int at, int stride, vec3 x, vec3 n, float sides) {
  const VplEntry v = vplEntry(texelFetch(direct, at), texelFetch(direct, at + 1), texelFetch(direct, at + 2),
                              texelFetch(direct, at + 3));
  const float e = irradianceFrom(v, v.position - x, n, sides > 1.5);
  return stride == kTexturedEntryTexels ? e * texelFetch(direct, at + 4).rgb : vec3(e);
}

/// As GATHER walks it (shaders/transport/gather.comp), but for a point. From `most` rounds on nodes are taken whole.
vec3 treeIrradiance(int first, int entries, int stride, vec3 x, vec3 n, float sides, float k, inout int rounds,
                    int most) {
  vec3 sum = vec3(0.0);
  for (int at = 0; at < entries;) {
    const vec4 node = texelFetch(direct, first + at * stride), next = texelFetch(direct, first + at * stride + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec3 d = node.xyz - x;
    const bool leaf = after == at + 1 + vpls;
    const bool whole = leaf || dot(d, d) > k * k * node.w * node.w || rounds > most;
    const int last = whole ? at + vpls : at;
    for (int i = at + 1; i <= last; ++i) sum += vplIrradiance(first + i * stride, stride, x, n, sides);
    rounds += 1 + last - at;
    at = whole ? after : at + 1 + vpls;
  }
  return sum;
}

/// The same of an emitter tree whose texels begin at `first`: leaves from near are triangles. Tree space.
float emitterTreeIrradiance(int first, int entries, vec3 x, vec3 n, float sides, float k, inout int rounds, int most) {
  const int begin = first + kTreeSpaceTexels;
  float sum = 0.0;
  for (int at = 0; at < entries;) {
    const vec4 node = texelFetch(direct, begin + at * kPlainEntryTexels);
    const vec4 next = texelFetch(direct, begin + at * kPlainEntryTexels + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec3 d = node.xyz - x;
    const bool far = dot(d, d) > k * k * node.w * node.w || rounds > most;
    const int last = far ? at + vpls : at, triangles = far ? 0 : int(next.z);
    for (int i = at + 1; i <= last; ++i) {
      sum += vplIrradiance(begin + i * kPlainEntryTexels, kPlainEntryTexels, x, n, sides).x;
    }
    sum += polygonIrradiance(first + int(next.w), triangles, x, n, sides);
    rounds += 1 + last - at + triangles;
    at = far ? after : at + 1 + vpls;
  }
  return sum;
}

/// What light i gives. From `most` rounds on nodes are taken whole.
vec3 lightIrradiance(int i, vec3 x, vec3 n, float k, inout int rounds, int most) {
  const vec4 radiance = texelFetch(direct, 1 + 2 * i), where = texelFetch(direct, 2 + 2 * i);
  const int first = int(where.x), count = int(where.y);
  if (radiance.w == kAsPolygons) {
    rounds += count;
    return radiance.rgb * polygonIrradiance(first, count, x, n, where.z);
  }
  if (radiance.w == kAsEmitterTree) {
    const TreeSpace s = treeSpace(first);
    return radiance.rgb *
           emitterTreeIrradiance(first, count, positionIn(s, x), normalIn(s, n), where.z, k, rounds, most);
  }
  return radiance.rgb * treeIrradiance(first, count, int(where.w), x, n, where.z, k, rounds, most);
}

/// E in W/m^2 at a grid position on a surface with unit normal n. All lights together are given kMaxRounds, each an
/// equal share of what those before it left.
vec3 directIrradiance(vec3 x, vec3 n) {
  const vec4 what = texelFetch(direct, 0);
  const int lights = int(what.x);
  vec3 sum = vec3(0.0);
  int rounds = 0;
  for (int i = 0; i < lights; ++i) {
    sum += lightIrradiance(i, x, n, what.y, rounds, rounds + (kMaxRounds - rounds) / (lights - i));
  }
  return sum;
}

/// The shares of lights that are looked at wherever the receiver is.
vec3 lookedAtIrradiance(vec3 x, vec3 n) {
  const vec4 what = texelFetch(direct, 0);
  const int first = 1 + 2 * int(what.x), lights = int(what.z);
  vec3 sum = vec3(0.0);
  int rounds = 0;
  for (int i = 0; i < lights; ++i) {
    const vec4 light = texelFetch(direct, first + i);
    sum += light.y * lightIrradiance(int(light.x), x, n, what.y, rounds, rounds + (kMaxRounds - rounds) / (lights - i));
  }
  return sum;
}
