// How much of a pool of lights is seen from the points of a list: rays to points of the lights, four
// a dispatch (MATHS.md 3d). A point goes on after the first four only if these, or those of the points beside it,
// disagree: elsewhere it is in the light or in the dark, or behind an even pane. A patch that is a triangle looks from another
// place each turn, and has all turns. Threads per point.
#include "layout.h"
#include "visibility/patches.glsl"
#include "visibility/receivers.glsl"
#include "visibility/shadow_points.glsl"
#include "visibility/patch_sums.glsl"
#define LPV_FACING 1
#include "visibility/light_points.glsl"
#include "visibility/occluders.glsl"

layout(local_size_x = 4 * kNearFieldGroup) in;

#if !LPV_PATCHES && !LPV_MET && !LPV_APART
layout(binding = kNearFieldOut, rgba32f) readonly uniform image2D nearField;  // as in near_field.comp
#endif

const float kMixed = -2.0;  // for the rays of a point that arrived (ShadowPoint): each with another share
const float kSameShare = 1e-3;
const float kOwnShare = 0.25;  // of what a pool sends, beside other light, before it is known how much arrives
const float kFullTurns = 2.0;  // where a pool sends half of what is there it has all turns
const uint kFoursBeside = 2u;  // on either side: the other half of a row of eight, and the rows above and below

/// What first rays met, as ShadowPoint::light.a: `shares` of the `sent` ones, -1 for the others.
float firstMet(vec4 shares, float sent) {
  float least = 4.0, most = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (shares[i] < 0.0) continue;
    least = min(least, shares[i]);
    most = max(most, shares[i]);
  }
  if (sent == 0.0 || most == 0.0) return sent == 0.0 ? -1.0 : 0.0;
  const bool few = sent < 4.0 && shadow.even == 0;  // evenly spread ones may be below the horizon
  return few || most - least > kSameShare ? kMixed : 4.0 * most;
}

/// Whether another four decides with a four: in single frames those beside it in its block of pixels, which were listed
/// one after the other, since 16 rays miss a light of which little is seen once in a while.
bool decidesWith(uint other, uint four) {
  return other == four || (shadow.apart > 0 && blockOf(other) == blockOf(four));
}

/// How much a point has seen in the turns before, as others may ask: what a turn counts goes where this turn does not read.
float seenBefore(uint point) { return (shadow.turn & 1) == 1 ? shadowPoints[point].seen.a : shadowPoints[point].known.a; }

void countSeen(uint point, float seen) {
  const float all = seen + max(shadowPoints[point].seen.a, shadowPoints[point].known.a);
  if ((shadow.turn & 1) == 0) shadowPoints[point].seen.a = all;
  else shadowPoints[point].known.a = all;
}

/// Whether the first rays of a point and of those beside it all met the same: the light, or what stands before it. Where
/// darkness is believed later, none of them may have seen anything since, either.
bool agreed(uint four) {
  float least = 8.0, most = -1.0, since = 0.0;
  for (uint i = four - min(four, kFoursBeside); i <= min(four + kFoursBeside, list.count - 1u); ++i) {
    if (!decidesWith(i, four)) continue;
    for (uint point = 4u * i; point < 4u * i + 4u; ++point) {
      const float met = shadowPoints[point].light.a;
      if (met == kMixed) return false;
      if (shadow.darkTurns > 1) since = max(since, seenBefore(point));
      if (met < 0.0) continue;
      least = min(least, met);
      most = max(most, met);
    }
  }
  if (most <= 0.0 && (shadow.turn < shadow.darkTurns || since > 0.0)) return false;
  return most - least <= 4.0 * kSameShare;
}

/// agreed(), which is found once where darkness is believed at once: it does not change then, and asking costs as much as
/// a ray.
bool isDecided(uint point, uint four) {
  if (shadow.darkTurns > 1) return agreed(four);
  for (bool first = shadow.turn == 1; first; first = false) shadowPoints[point].seen.a = agreed(four) ? 1.0 : 0.0;
  return shadowPoints[point].seen.a == 1.0;
}

/// What has arrived of other pools already.
vec3 otherLight(uint point, ivec2 pixel) {
#if LPV_PATCHES
  return vec3(0.0);
#elif LPV_MET || LPV_APART
  return shadow.pool > 0 ? shadowPoints[point].sum.rgb : vec3(0.0);
#else
  return shadow.apart > 0 ? imageLoad(nearField, pixel).rgb : vec3(0.0);
#endif
}

/// How many turns a point has: fewer where what the pool sends is little beside what has come from elsewhere. What its own
/// rays meet must not say: those that were lucky would be the last.
float turnsOf(uint point, ivec2 pixel) {
  const float light = dot(shadowPoints[point].light.rgb, vec3(1.0)), other = dot(otherLight(point, pixel), vec3(1.0));
  return ceil(float(shadow.turns) * min(kFullTurns * light / (other + kOwnShare * light), 1.0));
}

/// A sequence over the picture whose neighbours, so many pixels apart, differ much (Roberts 2018).
float shiftAt(ivec2 pixel, int apart) {
  return fract(dot(vec2(pixel & 1023) / float(apart), vec2(0.7548776662, 0.5698402910)));
}
float shiftAt(ivec2 pixel) { return shiftAt(pixel, 1); }

/// Turns come in an order in which the first few are spread, too.
int turnInOrder() { return shadow.turn * shadow.turnStep % shadow.turns; }

/// Where in a quarter of the weights this turn's rays go. All turns together cover it evenly; which comes first differs
/// from pixel to pixel, so that the first rays of four neighbours see much of the light.
float placeAt(ivec2 pixel) {
  const int turn = (turnInOrder() + int(shiftAt(pixel.yx + 255) * float(shadow.turns))) % shadow.turns;
  return (float(turn) + (shadow.smoothedBy == 0 ? 0.5 : shiftAt(pixel, shadow.smoothedBy))) / float(shadow.turns);
}

/// Which points are weighed.
float candidatesAt(ivec2 pixel) {
  return fract(0.6180339887 * float(turnInOrder()) + (shadow.jitter == 0 ? 0.5 : shiftAt(pixel.yx + 511)));
}

#if LPV_FROM_PATCHES
/// The patch where `place` lies, in [0, 1) of what all send, or -1.
int patchAt(uint point, float place, vec3 x, vec3 n) {
  const int last = batchOf(shadow.pointCount - 1);
  const float wanted = place * patchSum(point, last);
  int batch = 0;
  for (int stride = kPatchSumsOfPoint / 2; stride > 0; stride /= 2) {
    if (batch + stride <= last && patchSum(point, batch + stride - 1) <= wanted) batch += stride;
  }
  const int begin = batch * shadow.patchBatch;
  float sum = batch > 0 ? patchSum(point, batch - 1) : 0.0;
  int chosen = -1;
  for (int i = begin; i < min(begin + shadow.patchBatch, shadow.pointCount); ++i) {
    const float weight = pointWeight(i, x, n);
    if (weight > 0.0 && sum <= wanted) chosen = i;
    sum += weight;
  }
  return chosen;
}

/// The patches that a turn's rays go to, -1 for none: as many are chosen of each as its light is worth, so all rays are worth the
/// same.
ivec4 raysTo(uint point, vec3 x, vec3 n, ivec2 pixel, out vec4 weights) {
  ivec4 chosen;
  for (int i = 0; i < 4; ++i) chosen[i] = patchAt(point, 0.25 * (float(i) + placeAt(pixel)), x, n);
  weights = vec4(1.0);
  return chosen;
}
#else
/// The points that a turn's rays go to, -1 for none, and what each ray is worth beside others.
ivec4 raysTo(uint point, vec3 x, vec3 n, ivec2 pixel, out vec4 weights) {
  ivec4 chosen = ivec4(-1);
  if (shadow.even == 1) chosen = evenPoints(shadow.firstPoint, shadow.pointCount, x, n, placeAt(pixel), weights);
  if (chosen != ivec4(-1)) return chosen;  // else only other points than these four send light here
  float all;
  chosen = chosenPoints(shadow.firstPoint, shadow.pointCount, x, n, placeAt(pixel), candidatesAt(pixel), all);
  weights = vec4(all);
  return chosen;
}
#endif

#if LPV_FROM_PATCHES
const float kMostOfPiece = 4.0;  // times what its patch sends, in its place

/// A piece of one that stands for small triangles, `u` in [0, 1) of what they send; -1: it has none, or nobody looks for
/// them.
int pieceOf(int patch_, float u) {
  const int first = shadow.pointCount + int(patches[patch_].normal.w), count = int(patches[patch_].albedo.w);
  if (shadow.foldTurns == 0 || count == 0 || patches[patch_].corners[1].w >= 0.0) return -1;
  const float wanted = u * patches[first + count - 1].wanted;
  int begin = first, end = first + count - 1;
  while (begin < end) {
    const int middle = (begin + end) / 2;
    const bool before = patches[middle].wanted <= wanted;
    begin = before ? middle + 1 : begin;
    end = before ? end : middle;
  }
  return begin;
}

/// Where in a patch that is a triangle a ray goes, in [0, 1)^2: by other numbers than which patch it goes to.
vec2 placeInPatch(ivec2 pixel, int ray) {
  const mat2 pixelSteps = mat2(0.8191725134, 0.5497004779, 0.6710436067, 0.3819660113);
  return fract(pixelSteps * vec2(pixel & 1023) + float(ray) * vec2(0.7548776662, 0.5698402910));
}

/// How much a piece sends beside its patch, both as if nothing lay between.
float beside(int piece, int patch_, vec3 x, vec3 n) {
  const vec4 place = patches[piece].place, whole = patches[patch_].place;
  const float all = patchWeightPerArea(whole.xyz - x, whole.w, patches[patch_].normal.xyz, n);
  const float own = patchWeightPerArea(place.xyz - x, place.w, patches[piece].normal.xyz, n);
  return all > 0.0 ? min(own / all, kMostOfPiece) : 1.0;
}
#endif

#if LPV_TRANSPARENT
/// What haze leaves of what the pool sends, over as many points as are weighed. It belongs to what is sent, not to the share
/// that arrives: so it is no reason for more rays, and is not smoothed like what few of them have seen, but on its own
/// (shadow_sum.comp).
float keptInHaze(vec3 x, vec3 n, ivec2 pixel) {
  const float shift = candidatesAt(pixel);
  float kept = 0.0, all = 0.0;
  for (int k = 0; k < kCandidates; ++k) {
    // Another place of each part: the same of all would be as if the light were moved.
    const LightPart part = partOf(shadow.firstPoint, shadow.pointCount, k, fract(shift + 0.6180339887 * float(k)), x);
    const float weight = partWeight(part, x, n);
    kept += weight * throughHaze(x, pointPosition(part.one));
    all += weight;
  }
  return all > 0.0 ? kept / all : 1.0;
}
#endif

void sendRays(uint point, ivec2 pixel) {
#if LPV_PATCHES
  const vec3 n = receiverNormal(pixel), x = rayStart(pixel, n, turnInOrder());
#else
  const vec3 n = receiverNormal(pixel), x = rayStart(pixel, n);
#endif
  vec4 weights;
  const ivec4 chosen = raysTo(point, x, n, inPicture(pixel), weights);
  vec4 all = vec4(0.0), shares = vec4(-1.0);
  vec3 seen = vec3(0.0);
  float seenRays = 0.0;
  for (int i = 0; i < 4; ++i) {
    if (chosen[i] < 0) continue;
    vec3 to = texelFetch(lightPoints, kLightPointTexels * chosen[i]).xyz;
    float worth = 1.0;
#if LPV_FROM_PATCHES
    const int piece = pieceOf(chosen[i], fract(shiftAt(inPicture(pixel).yx + 77) + 0.6180339887 * float(4 * shadow.turn + i)));
    if (piece >= 0) {
      to = patches[piece].place.xyz + kShadowOffset * patches[piece].normal.xyz;
      worth = beside(piece, chosen[i], x, n);
    } else if (patches[chosen[i]].corners[0].w != 0.0) {
      to = ownPlace(patches[chosen[i]], placeInPatch(inPicture(pixel), 4 * shadow.turn + i)) + kShadowOffset * patches[chosen[i]].normal.xyz;
      worth = sentAt(patches[chosen[i]], to);
    }
#endif
    const vec4 colour = texelFetch(lightPoints, kLightPointTexels * chosen[i] + 2);
    const vec3 share = transmitted(x, mix(x, to, kShadowEnd), max(int(colour.a), kFromSurfaces));
    all += vec4(weights[i] * colour.rgb, 1.0);
    seen += weights[i] * worth * share * colour.rgb;
    seenRays += max(max(share.r, share.g), share.b);
    shares[i] = dot(share, vec3(0.5, 0.3, 0.2));  // another number for another colour, about
  }
  if (shadow.turn == 0) {
    shadowPoints[point].light.a = firstMet(shares, all.a);
#if LPV_TRANSPARENT
    if (hazeExtinction() > 0.0) shadowPoints[point].sum.a = keptInHaze(x, n, inPicture(pixel));
#endif
  }
  shadowPoints[point].all += all;
  shadowPoints[point].seen.rgb += seen;
  if (shadow.darkTurns > 1) countSeen(point, seenRays);
}

void main() {
  const uint point = gl_GlobalInvocationID.x, four = point / 4u;
  if (four >= list.count) return;
  const vec3 light = shadowPoints[point].light.rgb;
  if (max(max(light.r, light.g), light.b) <= 0.0) return;
  const ivec2 pixel = receiverOf(points[four][point % 4u]);
  if (shadow.turn == 0) {
    shadowPoints[point].sent.a = turnsOf(point, pixel);
  } else if (float(shadow.turn) >= shadowPoints[point].sent.a || (!isTriangle(pixel) && isDecided(point, four))) {
    return;
  }
  sendRays(point, pixel);
}
