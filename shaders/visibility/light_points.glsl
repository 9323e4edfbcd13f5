// Points of the lights' surfaces, and which of them shadow rays go to (MATHS.md 3d). Texels of a point, grid space:
//   (position, area x brightness)
//   (direction that it emits about, sides that emit; - area of a patch of a surface, which emits from one)
//   (colour: radiance as a share of brightness, the light; -1: none)
// Every n-th point of a range is a sample of the whole range (server/scene/light_points.h).
//
// LPV_FACING: receivers are on surfaces and have normals; else they are points in space.
#ifndef LPV_FACING
#error "LPV_FACING: 0 or 1"
#endif

layout(binding = kLightPoints) uniform samplerBuffer lightPoints;

const int kCandidates = 32;  // points of a range that are weighed for four rays

/// What a receiver at x, with normal n, gets from point i, about, and as if nothing lay between: irradiance, or fluence.
float pointWeight(int i, vec3 x, vec3 n) {
  const vec4 place = texelFetch(lightPoints, kLightPointTexels * i);
  const vec4 emits = texelFetch(lightPoints, kLightPointTexels * i + 1);
  const vec3 d = place.xyz - x;
  const float along = -dot(emits.xyz, d), towards = emits.w > 1.5 ? abs(along) : max(along, 0.0);
  const float r2 = dot(d, d) + 1e-8;
#if LPV_FACING
  const float reach2 = max(-emits.w, 0.0) * 0.3183098862;  // of a patch, a disc
  return place.w * towards * max(dot(n, d), 0.0) / (r2 * (r2 + reach2));
#else
  return place.w * towards * inversesqrt(r2) / r2;
#endif
}

/// Four points of [first, first + count) in proportion to their weights; -1 where all are 0. `place` in [0, 1): of each
/// choice in its quarter of the weights; `shift` in [0, 1): which points are weighed.
ivec4 chosenPoints(int first, int count, vec3 x, vec3 n, float place, float shift) {
  const float spacing = float(count) / float(kCandidates);
  float all = 0.0;
  for (int k = 0; k < kCandidates; ++k) all += pointWeight(first + int((float(k) + shift) * spacing), x, n);
  const vec4 places = 0.25 * all * (vec4(0.0, 1.0, 2.0, 3.0) + place);
  ivec4 chosen = ivec4(-1);
  float sum = 0.0;
  for (int k = 0; k < kCandidates; ++k) {
    const int i = first + int((float(k) + shift) * spacing);
    const float before = sum;
    sum += pointWeight(i, x, n);
    const bvec4 here = bvec4(ivec4(greaterThanEqual(places, vec4(before))) * ivec4(lessThan(places, vec4(sum))));
    chosen = mix(chosen, ivec4(i), here);
  }
  return chosen;
}
