// What shaders/transport/emitter_list.glsl does for one receiver, for four that are close together: what is read of the
// lights serves them all. A node is taken whole where it is far enough from each of them.
#include "layout.h"
#include "transport/polygons.glsl"
#define LPV_RECEIVERS 4
#define LPV_RECEIVERS_APART
#include "transport/vpl_kernel.glsl"

layout(binding = kDirect) uniform samplerBuffer direct;

/// Grid positions, and unit normals of the surfaces that they are on.
struct FourReceivers {
  vec4 x, y, z;
  vec4 nx, ny, nz;
};

/// W/m^2, per receiver.
struct FourIrradiances {
  vec4 red, green, blue;
};

void add(inout FourIrradiances sum, vec3 radiance, vec4 e) {
  sum.red += radiance.r * e;
  sum.green += radiance.g * e;
  sum.blue += radiance.b * e;
}

float triangleAt(int at, vec3 x, vec3 n, float sides) {
  return triangleIrradiance(texelFetch(direct, at).xyz - x, texelFetch(direct, at + 1).xyz - x,
                            texelFetch(direct, at + 2).xyz - x, n, sides);
}

vec4 polygonIrradiance(int first, int triangles, FourReceivers r, float sides) {
  const vec3 x0 = vec3(r.x.x, r.y.x, r.z.x), n0 = vec3(r.nx.x, r.ny.x, r.nz.x);
  const vec3 x1 = vec3(r.x.y, r.y.y, r.z.y), n1 = vec3(r.nx.y, r.ny.y, r.nz.y);
  const vec3 x2 = vec3(r.x.z, r.y.z, r.z.z), n2 = vec3(r.nx.z, r.ny.z, r.nz.z);
  const vec3 x3 = vec3(r.x.w, r.y.w, r.z.w), n3 = vec3(r.nx.w, r.ny.w, r.nz.w);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < triangles; ++i) {
    const int at = first + 3 * i;
    sum += vec4(triangleAt(at, x0, n0, sides), triangleAt(at, x1, n1, sides), triangleAt(at, x2, n2, sides),
                triangleAt(at, x3, n3, sides));
  }
  return sum;
}

/// Whether the VPL at texel `at` faces away from all four, so that nothing arrives.
bool facesAway(int at, FourReceivers r, float sides) {
  const vec4 place = texelFetch(direct, at), emission = texelFetch(direct, at + 1);
  const vec4 dx = place.x - r.x, dy = place.y - r.y, dz = place.z - r.z;
  const vec4 away = emission.x * dx + emission.y * dy + emission.z * dz;
  const vec4 within = emission.w * emission.w * (dx * dx + dy * dy + dz * dz);
  return sides < 1.5 && all(greaterThan(away * abs(away), within));
}

/// The first VPL after entry i of those up to `last` that does not face away; last + 1: none. About half of a closed mesh
/// does, and is passed over by a loop of its own: llvmpipe walks through both sides of branches.
int nextFacing(int i, int last, int first, int stride, FourReceivers r, float sides) {
  for (++i; i <= last; ++i) {
    if (!facesAway(first + i * stride, r, sides)) break;
  }
  return i;
}

/// Of the VPL at texel `at`.
vec4 vplIrradiance(int at, FourReceivers r, float sides) {
  const VplEntry v = vplEntry(texelFetch(direct, at), texelFetch(direct, at + 1), texelFetch(direct, at + 2),
                              texelFetch(direct, at + 3));
  return irradianceFrom(v, v.position.x - r.x, v.position.y - r.y, v.position.z - r.z, r.nx, r.ny, r.nz, sides > 1.5);
}

/// Adds what a light's tree gives. From `most` rounds on nodes are taken whole.
void addTree(inout FourIrradiances sum, vec3 radiance, vec4 where, FourReceivers r, float k, inout int rounds,
             int most) {
  const int first = int(where.x), entries = int(where.y), stride = int(where.w);
  for (int at = 0; at < entries;) {
    const vec4 node = texelFetch(direct, first + at * stride), next = texelFetch(direct, first + at * stride + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec4 dx = node.x - r.x, dy = node.y - r.y, dz = node.z - r.z;
    const bool leaf = after == at + 1 + vpls;
    const bool far = all(greaterThan(dx * dx + dy * dy + dz * dz, vec4(k * k * node.w * node.w)));
    const bool whole = leaf || far || rounds > most;
    const int last = whole ? at + vpls : at;
    for (int i = nextFacing(at, last, first, stride, r, where.z); i <= last;
         i = nextFacing(i, last, first, stride, r, where.z)) {
      ++rounds;
      const int texel = first + i * stride;
      const vec3 colour = stride == kTexturedEntryTexels ? texelFetch(direct, texel + 4).rgb : vec3(1.0);
      add(sum, radiance * colour, vplIrradiance(texel, r, where.z));
    }
    rounds += 1 + last - at;
    at = whole ? after : at + 1 + vpls;
  }
}

FourReceivers inTreeSpace(FourReceivers r, int at) {
  const vec4 a = texelFetch(direct, at), b = texelFetch(direct, at + 1), c = texelFetch(direct, at + 2);
  const float unit = inversesqrt(dot(a.xyz, a.xyz));
  const vec3 na = unit * a.xyz, nb = unit * b.xyz, nc = unit * c.xyz;
  return FourReceivers(a.x * r.x + a.y * r.y + a.z * r.z + a.w, b.x * r.x + b.y * r.y + b.z * r.z + b.w,
                       c.x * r.x + c.y * r.y + c.z * r.z + c.w, na.x * r.nx + na.y * r.ny + na.z * r.nz,
                       nb.x * r.nx + nb.y * r.ny + nb.z * r.nz, nc.x * r.nx + nc.y * r.ny + nc.z * r.nz);
}

/// Adds what an emitter tree gives, whose texels begin at `first`: leaves that are near to one of the receivers are
/// triangles for all four. Tree space.
void addEmitterTree(inout FourIrradiances sum, vec3 radiance, int first, int entries, FourReceivers r, float sides,
                    float k, inout int rounds, int most) {
  const int begin = first + kTreeSpaceTexels;
  vec4 e = vec4(0.0);
  for (int at = 0; at < entries;) {
    const vec4 node = texelFetch(direct, begin + at * kPlainEntryTexels);
    const vec4 next = texelFetch(direct, begin + at * kPlainEntryTexels + 1);
    const int vpls = int(next.x), after = int(next.y);
    const vec4 dx = node.x - r.x, dy = node.y - r.y, dz = node.z - r.z;
    const bool far = all(greaterThan(dx * dx + dy * dy + dz * dz, vec4(k * k * node.w * node.w))) || rounds > most;
    const int last = far ? at + vpls : at, triangles = far ? 0 : int(next.z);
    for (int i = nextFacing(at, last, begin, kPlainEntryTexels, r, sides); i <= last;
         i = nextFacing(i, last, begin, kPlainEntryTexels, r, sides)) {
      ++rounds;
      e += vplIrradiance(begin + i * kPlainEntryTexels, r, sides);
    }
    e += polygonIrradiance(first + int(next.w), triangles, r, sides);
    rounds += 1 + last - at + triangles;
    at = far ? after : at + 1 + vpls;
  }
  add(sum, radiance, e);
}

int lightsInList() { return int(texelFetch(direct, 0).x); }

/// As directIrradiance, of lights [begin, end), with so much of k. `rounds` of the thread's kMaxRounds are through.
FourIrradiances directIrradiances(FourReceivers r, int begin, int end, float openingShare, inout int rounds) {
  const float k = openingShare * texelFetch(direct, 0).y;
  FourIrradiances sum = FourIrradiances(vec4(0.0), vec4(0.0), vec4(0.0));
  for (int i = begin; i < end; ++i) {
    const vec4 radiance = texelFetch(direct, 1 + 2 * i), where = texelFetch(direct, 2 + 2 * i);
    const int most = rounds + (kMaxRounds - rounds) / (end - i);
    if (radiance.w == kAsPolygons) {
      add(sum, radiance.rgb, polygonIrradiance(int(where.x), int(where.y), r, where.z));
      rounds += int(where.y);
    } else if (radiance.w == kAsEmitterTree) {
      addEmitterTree(sum, radiance.rgb, int(where.x), int(where.y), inTreeSpace(r, int(where.x)), where.z, k, rounds,
                     most);
    } else {
      addTree(sum, radiance.rgb, where, r, k, rounds, most);
    }
  }
  return sum;
}
