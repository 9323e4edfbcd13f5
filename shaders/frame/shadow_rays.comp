// How much of a pool of lights is seen from the points of a list: rays to points of the lights, four
// a dispatch (MATHS.md 3d). A point goes on after the first four only if these, or those of the three points beside it,
// disagree: elsewhere it is in the light or in the dark. Threads per point.
#include "layout.h"
#include "visibility/receivers.glsl"
#define LPV_FACING 1
#include "visibility/light_points.glsl"
#include "visibility/occluders.glsl"
#include "visibility/shadow_points.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

/// Whether the first rays of a point and of those beside it all met the same: the light, or something before it.
bool agreed(uint four) {
  float arrived = 0.0, sent = 0.0;
  for (uint i = 4u * four; i < 4u * four + 4u; ++i) {
    const float count = shadowPoints[i].light.a;
    if (count < 0.0) continue;
    arrived += count;
    sent += 4.0;
  }
  return arrived == 0.0 || arrived == sent;
}

/// A sequence over the picture whose neighbours differ much (Roberts 2018).
float shiftAt(ivec2 pixel) { return fract(dot(vec2(pixel & 1023), vec2(0.7548776662, 0.5698402910))); }

/// Where in a quarter of the weights this turn's rays go. All turns together cover it evenly; which comes first differs
/// from pixel to pixel, so that the first rays of four neighbours see much of the light.
float placeAt(ivec2 pixel) {
  const int turn = (shadow.turn + int(shiftAt(pixel.yx + 255) * float(shadow.turns))) % shadow.turns;
  return (float(turn) + (shadow.jitter == 0 ? 0.5 : shiftAt(pixel))) / float(shadow.turns);
}

/// Which points are weighed.
float candidatesAt(ivec2 pixel) {
  return fract(0.6180339887 * float(shadow.turn) + (shadow.jitter == 0 ? 0.5 : shiftAt(pixel.yx + 511)));
}

void sendRays(uint point, ivec2 pixel) {
  const vec3 n = receiverNormal(pixel), x = receiverPosition(pixel) + kShadowOffset * n;
  const ivec4 chosen =
      chosenPoints(shadow.firstPoint, shadow.pointCount, x, n, placeAt(pixel), candidatesAt(pixel));
  vec4 all = vec4(0.0), seen = vec4(0.0);
  for (int i = 0; i < 4; ++i) {
    if (chosen[i] < 0) continue;
    const vec3 to = texelFetch(lightPoints, kLightPointTexels * chosen[i]).xyz;
    const vec4 colour = texelFetch(lightPoints, kLightPointTexels * chosen[i] + 2);
    const vec4 ray = vec4(colour.rgb, 1.0);
    all += ray;
    seen += ray * open(x, mix(x, to, kShadowEnd), int(colour.a));
  }
  if (shadow.turn == 0) shadowPoints[point].light.a = all.a > 0.0 ? seen.a : -1.0;
  shadowPoints[point].all += all;
  shadowPoints[point].seen += seen;
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const vec3 light = shadowPoints[point].light.rgb;
  if (max(max(light.r, light.g), light.b) <= 0.0 || (shadow.turn > 0 && agreed(four))) return;
  sendRays(point, unpackedPixel(points[four][point % 4u]));
}
