// Points of the lights' surfaces, and which of them shadow rays go to (MATHS.md 3d). Texels of a point, grid space:
//   (position, area x brightness)
//   (direction that it emits about, sides that emit; - area of a patch of a surface, which emits from one)
//   (colour: radiance as a share of brightness; the light, or kFromSurfaces, or kFromFolds and less)
// Every n-th point of a range is a sample of the whole range (server/scene/light_points.h).
//
// LPV_FACING: receivers are on surfaces and have normals (and visibility/shadow_points.glsl); else they are points in
// space.
#ifndef LPV_FACING
#error "LPV_FACING: 0 or 1"
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
  const float along = -dot(emits.xyz, d), towards = emits.w > 1.5 ? abs(along) : max(along, 0.0);
  const float r2 = dot(d, d) + 1e-8;
#if LPV_FACING
  if (emits.w < 0.0 && (r2 < -kAskedPatch * emits.w || isFolded(dot(d, d), texelFetch(lightPoints, kLightPointTexels * i + 2).a)))
    return 0.0;
  if (emits.w < 0.0) return place.w * patchWeightPerArea(d, -emits.w, emits.xyz, n);
  return place.w * towards * max(dot(n, d), 0.0) / (r2 * r2);
#else
  return place.w * towards * inversesqrt(r2) / r2;
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
  const vec3 middle = pointPosition((begin + end) / 2), d = middle - x;
  const vec3 before = pointPosition(begin) - middle, after = pointPosition(end - 1) - middle;
  const float size2 = max(dot(before, before), dot(after, after));
  const bool patches = texelFetch(lightPoints, kLightPointTexels * one + 1).w < 0.0;
  return LightPart(begin, end, one, !patches && dot(d, d) < kNearParts * size2);
}

/// Of a point of the part, on average.
float partWeight(LightPart p, vec3 x, vec3 n) {
  const int begin = p.near ? p.begin : p.one, end = p.near ? p.end : p.one + 1;
  float sum = 0.0;
  for (int i = begin; i < end; ++i) sum += pointWeight(i, x, n);
  return sum / float(end - begin);
}

/// A point of the part in proportion to the points' weights, `place` in [0, 1) of them.
int pointOf(LightPart p, vec3 x, vec3 n, float place) {
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

/// Four points spread over [first, first + count), one of each quarter; `place` in [0, 1): of the quarter. What each
/// sends is its weight; -1 where that is 0.
ivec4 evenPoints(int first, int count, vec3 x, vec3 n, float place, out vec4 weights) {
  ivec4 chosen = first + ivec4(0.25 * float(count) * (vec4(0.0, 1.0, 2.0, 3.0) + place));
  for (int i = 0; i < 4; ++i) {
    weights[i] = pointWeight(chosen[i], x, n);
    if (weights[i] <= 0.0) chosen[i] = -1;
  }
  return chosen;
}

/// Four points of [first, first + count) in proportion to their weights; -1 where all are 0. `place` in [0, 1): of each
/// choice in its quarter of the weights; `shift` in [0, 1): which points are weighed; `all`: their weights' sum, which
/// is what rays to the four stand for.
ivec4 chosenPoints(int first, int count, vec3 x, vec3 n, float place, float shift, out float all) {
  all = 0.0;
  for (int k = 0; k < kCandidates; ++k) all += partWeight(partOf(first, count, k, shift, x), x, n);
  const vec4 places = 0.25 * all * (vec4(0.0, 1.0, 2.0, 3.0) + place);
  ivec4 parts = ivec4(-1), chosen = ivec4(-1);
  vec4 within = vec4(0.0);
  float sum = 0.0;
  for (int k = 0; k < kCandidates; ++k) {
    const float before = sum;
    sum += partWeight(partOf(first, count, k, shift, x), x, n);
    const bvec4 here = bvec4(ivec4(greaterThanEqual(places, vec4(before))) * ivec4(lessThan(places, vec4(sum))));
    parts = mix(parts, ivec4(k), here);
    within = mix(within, (places - before) / max(sum - before, 1e-30), here);
  }
  for (int i = 0; i < 4; ++i) {
    if (parts[i] >= 0) chosen[i] = pointOf(partOf(first, count, parts[i], shift, x), x, n, within[i]);
  }
  return chosen;
}
