// Points of the lights' surfaces, and which of them shadow rays go to (MATHS.md 3d). Texels of a point, grid space:
//   (position, area x brightness)
//   (direction that it emits about, sides that emit; - area of a patch of a surface, which emits from one)
//   (colour: radiance as a share of brightness; the light, or kFromSurfaces, or kFromFolds and less)
// Every n-th point of a range is a sample of the whole range (server/scene/light_points.h).
//
// LPV_FROM_PATCHES: all points of a range are patches of surfaces, or none is.
// LPV_FACING: receivers are on surfaces and have normals (and visibility/shadow_points.glsl); else they are points in
// space.
#if !defined LPV_FACING || !defined LPV_FROM_PATCHES
#error "LPV_FACING, LPV_FROM_PATCHES: 0 or 1"
#endif

#include "visibility/patch_weight.glsl"

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

const int kCandidates = 32;  // points of a range that are weighed for four rays
const float kNearParts = 16.0;  // by the square of the distance over that of a part's size

/// What a receiver at x, with normal n, gets from point i, about, and as if nothing lay between: irradiance, or fluence.
/// Patches that are near have been asked already (patch_light.comp), or their pieces have (fold_rays.comp).
float pointWeight(int i, vec3 x, vec3 n) {
  const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
  const vec3 d = place.xyz - x;
#if LPV_FROM_PATCHES
  const float area = -emits.w;
  const float share = shareToAsk(dot(d, d), area, texelFetch(lightPoints, kLightPointTexels * i + 2).a);
  return share * place.w * patchWeightPerArea(d, area, emits.xyz, n);
#else
  const float along = -dot(emits.xyz, d), towards = emits.w > 1.5 ? abs(along) : max(along, 0.0);
  const float r2 = dot(d, d) + 1e-8;
#if LPV_FACING
  return place.w * towards * max(dot(n, d), 0.0) / (r2 * r2);
#else
  return place.w * towards * inversesqrt(r2) / r2;
#endif
#endif
}

/// What one candidate stands for: points next to each other, of which a receiver that is near weighs all, another the
/// one.
struct LightPart {
  int begin, end, one;
  bool near;
};

vec3 pointPosition(int i) { return texelFetch(lightPoints, kLightPointTexels * i).xyz; }

/// The k-th of a range. Patches that follow each other need not be neighbours: they are never near. Which parts are near
/// must not go by the one point: those whose point is near would count as their mean, and the others as that point, which
/// is too little (knot that shadows itself: 5 % too dark).
LightPart partOf(int first, int count, int k, float shift, vec3 x) {
  const float spacing = float(count) / float(kCandidates);
  const int begin = first + int(float(k) * spacing), end = max(first + int(float(k + 1) * spacing), begin + 1);
  const int one = first + int((float(k) + shift) * spacing);
#if LPV_FROM_PATCHES
  return LightPart(begin, end, one, false);
#else
  const vec3 middle = pointPosition((begin + end) / 2), d = middle - x;
  const vec3 before = pointPosition(begin) - middle, after = pointPosition(end - 1) - middle;
  const float size2 = max(dot(before, before), dot(after, after));
  return LightPart(begin, end, one, dot(d, d) < kNearParts * size2);
#endif
}

/// Of a point of the part, on average.
float partWeight(LightPart p, vec3 x, vec3 n) {
  const int begin = p.near ? p.begin : p.one, end = p.near ? p.end : p.one + 1;
  float sum = 0.0;
  for (int i = begin; i < end; ++i) sum += pointWeight(i, x, n);
  return sum / float(end - begin);
}

/// A point of the part in proportion to the points' weights, `place` in [0, 1) of them. Of a part that is not near: of a flat light
/// the point that lies there, if it is about as bright as the one that was weighed; else that one.
int pointOf(LightPart p, vec3 x, vec3 n, float place, bool flatLight) {
#if !LPV_FROM_PATCHES
  if (!p.near && flatLight) {
    const int there = p.begin + int(place * float(p.end - p.begin));
    const float weighed = pointWeight(p.one, x, n);
    return abs(pointWeight(there, x, n) - weighed) < 0.1 * weighed ? there : p.one;
  }
#endif
  const float wanted = place * partWeight(p, x, n) * float(p.end - p.begin);
  int chosen = p.one;
  float sum = 0.0;
  for (int i = p.begin; i < (p.near ? p.end : p.begin); ++i) {
    const float before = sum;
    sum += pointWeight(i, x, n);
    if (before <= wanted && wanted < sum) chosen = i;
  }
  return chosen;
}

/// Whether all of a range emits about one direction, by five of its points.
bool isFlat(int first, int count) {
  const vec3 direction = texelFetch(lightPoints, kLightPointTexels * first + 1).xyz;
  bool same = true;
  for (int i = 1; i <= 4; ++i)
    same = same && dot(texelFetch(lightPoints, kLightPointTexels * (first + (count - 1) * i / 4) + 1).xyz, direction) > 0.999;
  return same;
}

/// Where in each quarter of a range a turn's point lies. Points follow Morton's curve: the quarters of a flat light are its
/// corners, their quarters the corners of these, and so on. At `place`, the same in all quarters, points would stand in
/// rows, which an edge along a side of the light passes two by two or four by four. So corners are changed by those that
/// hold them, in the way of a (0, m, 2)-net (Niederreiter 1987): the points of one, two, four and more turns have as many
/// distances from each side as they are. Of other lights, points stay as far apart along the curve as they are (a knot: 13 % of
/// the pixels more than 10 % off, for 9.6).
vec4 placesInQuarters(float place, bool flatLight) {
  if (!flatLight) return vec4(place);
  const uvec4 qx = uvec4(0u, 1u, 0u, 1u), qy = uvec4(0u, 0u, 1u, 1u);
  const uint digits = uint(64.0 * place);
  const uvec2 first = uvec2(digits >> 4u, digits >> 5u), second = uvec2(digits >> 2u, digits >> 3u),
              third = uvec2(digits, digits >> 1u);
  // The halves of a place lie across from each other.
  const uvec4 sx = (first.x ^ first.y ^ qy) & 1u, sy = (first.y ^ qx) & 1u;
  const uvec4 tx = (second.x ^ second.y ^ sy) & 1u, ty = (second.y ^ sx) & 1u;
  const uvec4 ux = (third.x ^ third.y ^ ty ^ qy) & 1u, uy = (third.y ^ tx ^ qx) & 1u;
  const uvec4 turned = 32u * sy + 16u * sx + 8u * ty + 4u * tx + 2u * uy + ux;
  return (vec4(turned) + fract(64.0 * place)) / 64.0;
}

/// Four points spread over [first, first + count), one of each quarter; `place` in [0, 1): of the quarter. What each
/// sends is its weight; -1 where that is 0.
ivec4 evenPoints(int first, int count, vec3 x, vec3 n, float place, out vec4 weights) {
  ivec4 chosen = first + ivec4(0.25 * float(count) * (vec4(0.0, 1.0, 2.0, 3.0) + placesInQuarters(place, isFlat(first, count))));
  for (int i = 0; i < 4; ++i) {
    weights[i] = pointWeight(chosen[i], x, n);
    if (weights[i] <= 0.0) chosen[i] = -1;
  }
  return chosen;
}

/// The weights of 32 candidates, two by two, so that a choice weighs two of them again and not all: in vectors, since
/// llvmpipe is slow with arrays. add() in order, then summed().
struct WeightSums {
  vec4 a, b, c, d;
};

void add(inout WeightSums sums, int pair, float weight) {
  const vec4 here = mix(vec4(0.0), vec4(weight), equal(ivec4(pair % 4), ivec4(0, 1, 2, 3)));
  sums.a += pair / 4 == 0 ? here : vec4(0.0);
  sums.b += pair / 4 == 1 ? here : vec4(0.0);
  sums.c += pair / 4 == 2 ? here : vec4(0.0);
  sums.d += pair / 4 == 3 ? here : vec4(0.0);
}

vec4 summed(vec4 v, float before) {
  v.y += v.x;
  v.w += v.z;
  v.zw += v.y;
  return before + v;
}

/// Of each pair, with all before it.
WeightSums summed(WeightSums s) {
  s.a = summed(s.a, 0.0);
  s.b = summed(s.b, s.a.w);
  s.c = summed(s.c, s.b.w);
  s.d = summed(s.d, s.c.w);
  return s;
}

/// What of `v` is no more than `place`: how many, and the most.
void addUpTo(float place, vec4 v, inout int count, inout float most) {
  const bvec4 up = lessThanEqual(v, vec4(place));
  const ivec4 one = ivec4(up);
  const vec4 kept = mix(vec4(0.0), v, up);
  count += one.x + one.y + one.z + one.w;
  most = max(most, max(max(kept.x, kept.y), max(kept.z, kept.w)));
}

/// The pair that `place` lies in, of what summed() gives, and the sum before it; kCandidates / 2 past the last.
int pairAt(WeightSums s, float place, out float before) {
  int pair = 0;
  before = 0.0;
  addUpTo(place, s.a, pair, before);
  addUpTo(place, s.b, pair, before);
  addUpTo(place, s.c, pair, before);
  addUpTo(place, s.d, pair, before);
  return pair;
}

/// The point where `place` lies among the weights, or -1.
int pointAt(WeightSums sums, float place, int first, int count, vec3 x, vec3 n, float shift, bool flatLight) {
  float before, next;
  const int pair = pairAt(sums, place, before);
  if (pair >= kCandidates / 2) return -1;
  const LightPart one = partOf(first, count, 2 * pair, shift, x), other = partOf(first, count, 2 * pair + 1, shift, x);
  const float weight = partWeight(one, x, n), rest = partWeight(other, x, n);
  const bool isOther = rest > 0.0 && place >= before + weight;
  const float within = isOther ? (place - before - weight) / rest : (place - before) / max(weight, 1e-30);
  return isOther ? pointOf(other, x, n, within, flatLight) : pointOf(one, x, n, within, flatLight);
}

/// Four points of [first, first + count) in proportion to their weights; -1 where all are 0. `place` in [0, 1): of each
/// choice in its quarter of the weights; `shift` in [0, 1): which points are weighed; `all`: their weights' sum, which
/// is what rays to the four stand for.
ivec4 chosenPoints(int first, int count, vec3 x, vec3 n, float place, float shift, out float all) {
  WeightSums sums = WeightSums(vec4(0.0), vec4(0.0), vec4(0.0), vec4(0.0));
  for (int k = 0; k < kCandidates; ++k) add(sums, k / 2, partWeight(partOf(first, count, k, shift, x), x, n));
  sums = summed(sums);
  all = sums.d.w;
  ivec4 chosen = ivec4(-1);
  const bool flatLight = isFlat(first, count);
  const vec4 places = placesInQuarters(place, flatLight);
  for (int i = 0; i < 4; ++i)
    chosen[i] = pointAt(sums, 0.25 * all * (float(i) + places[i]), first, count, x, n, shift, flatLight);
  return chosen;
}
