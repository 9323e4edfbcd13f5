// The lights themselves at the points of a picture that near_field.comp has listed, four to a thread. These are close
// together, and the same ones in every run, so results are the same, too, whatever the order of the list. LPV_SHADOWED:
// E of one pool of lights, which is not put into the picture yet (shadow_rays.comp).
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

void main() {
  if (gl_GlobalInvocationID.x >= list.count) return;
  const uvec4 four = points[gl_GlobalInvocationID.x];
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
#if LPV_SHADOWED
  const FourIrradiances e = directIrradiances(r, shadow.firstLight, shadow.lightsEnd);
  for (int i = 0; i < 4; ++i) {
    begin(4u * gl_GlobalInvocationID.x + uint(i), vec3(e.red[i], e.green[i], e.blue[i]), vec3(0.0), vec3(0.0), false);
  }
#else
  const FourIrradiances e = directIrradiances(r, 0, lightsInList());
  for (int i = 0; i < 4; ++i) {
    const ivec2 pixel = unpackedPixel(four[i]);
    imageStore(nearField, pixel, vec4(e.red[i], e.green[i], e.blue[i], imageLoad(nearField, pixel).w));
  }
#endif
}
