// How what comes to a patch that is a triangle changes across it, and so what it sends: the plane through its own that fits
// best to what comes to patches beside it on one wall, with nothing between. In the corner of a room the next wall is
// darker than its patches are in the mean, and that part of it matters most there. A thread per patch. LPV_TRANSPARENT: panes
// may stand there.
#include "layout.h"
#include "common/sh.glsl"
#include "visibility/occluders.glsl"
#include "visibility/patches.glsl"

layout(local_size_x = kPatchGroup) in;

layout(std140, binding = kParams) uniform Block { PatchParams params; };
layout(std430, binding = kPatchLights) readonly buffer Lights { vec4 lights[]; };

const float kSameNormal = 0.999;
const float kSamePlane = 0.02;  // of a patch's width
const float kAround = 6.0;      // by the square of the distance over the area: two patches to each side
const float kFlat = 0.1;        // of the area: how much it counts that it may be as bright all over

float greatest(vec3 v) { return max(max(v.r, v.g), v.b); }

/// What comes to a patch, about: what it sends goes by boards and tiles, too.
float comingTo(int i) {
  return lights[kLightPointTexels * i].w / (patches[i].place.w * max(greatest(patches[i].albedo.rgb), 1e-6));
}

bool nothingBetween(Patch a, Patch b) {
  const vec3 up = kShadowOffset * a.normal.xyz;
  return transmitted(a.place.xyz + up, b.place.xyz + up, kAllLights) == vec3(1.0);
}

void main() {
  const int a = params.first + int(gl_GlobalInvocationID.x);
  if (a >= params.count) return;
  const Patch here = patches[a];
  patches[a].slope.xyz = vec3(0.0);
  const float own = comingTo(a);
  if (here.corners[0].w == 0.0 || own <= 0.0) return;
  const vec3 n = here.normal.xyz;
  const vec3 right = normalize(cross(n, abs(n.y) < 0.9 ? vec3(0.0, 1.0, 0.0) : vec3(1.0, 0.0, 0.0))), up = cross(n, right);
  const float width = sqrt(here.place.w);
  vec3 products = vec3(0.0);  // rr, ru, uu
  vec2 sums = vec2(0.0);
  for (int b = 0; b < params.count; ++b) {
    if (b == a || patches[b].corners[0].w == 0.0 || dot(patches[b].normal.xyz, n) < kSameNormal) continue;
    const vec3 d = patches[b].place.xyz - here.place.xyz;
    const float r2 = dot(d, d);
    if (r2 > kAround * here.place.w || abs(dot(d, n)) > kSamePlane * width || !nothingBetween(here, patches[b])) continue;
    const vec2 at = vec2(dot(d, right), dot(d, up));
    const float weight = patches[b].place.w / (r2 + here.place.w);
    products += weight * vec3(at.x * at.x, at.x * at.y, at.y * at.y);
    sums += weight * (comingTo(b) / own - 1.0) * at;
  }
  products.xz += kFlat * here.place.w;
  const float area = products.x * products.z - products.y * products.y;
  const vec2 slope = vec2(products.z * sums.x - products.y * sums.y, products.x * sums.y - products.y * sums.x) / area;
  patches[a].slope.xyz = slope.x * right + slope.y * up;
}
