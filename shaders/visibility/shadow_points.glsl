// Points of a picture while light is summed at them, pool of lights by pool.

struct ShadowPoint {
  vec4 light;  // rgb: E of the pool in W/m^2 as if nothing lay between; a: of the first four rays those that arrived,
               // or the sum of their shares; -1 where none were sent, less where they differ
  vec4 asked;  // rgb: of it what was asked about when it was found; a: how far away
               // pieces of folds may be that count, cells; 0: there are none
  vec4 known;  // rgb: of that what arrives; a: as seen.a, after odd turns
  vec4 all;    // rgb: colours of the points that rays were sent to, by what a turn's rays stand for; a: rays
  vec4 seen;   // rgb: of those that arrived; a: where darkness is believed later, how many
               // did, or their shares' largest, after even turns; else 1 where first rays agreed
  vec4 sum;    // rgb: E of the pools before; a: of this one's light what haze leaves (shadow_rays.comp), 0: none is there
  vec4 sent;   // rgb: what the pools before would send with nothing between, of samples that are lit apart; a: turns of
               // rays to this one, at most
};

layout(std140, binding = kShadowParams) uniform ShadowBlock { ShadowParams shadow; };
layout(std430, binding = kShadowPoints) buffer ShadowPoints { ShadowPoint shadowPoints[]; };

/// A pixel's place in the picture, whose rows are made some at a time: each sends rays of its own.
ivec2 inPicture(ivec2 pixel) { return pixel + ivec2(0, shadow.firstRow); }

/// Of what a patch sends, what its pieces are looked for instead, by the square of its distance and what its texel of the
/// list has in the place of a light (visibility/light_points.glsl): all within its reach, from there on less and less, or a
/// wall would show where that ends. Patches and pieces themselves look within reach alone.
const float kFoldedUpTo = 1.7;  // by the square of the distance, of the reach's
float foldedShare(float r2, float from) {
  if (shadow.foldTurns == 0 || from > kFromFolds) return 0.0;
  const float beyond = r2 / (kFromFolds - from);
#if LPV_PATCHES
  return beyond < 1.0 ? 1.0 : 0.0;
#else
  return 1.0 - smoothstep(1.0, kFoldedUpTo, beyond);
#endif
}

/// The block of a picture's pixels that a four is of: all of a block are listed one after the other.
ivec2 blockOf(uint four) {
  ivec2 pixel = receiverOf(points[four].x);
#if !LPV_PATCHES && LPV_MET
  const int width = pictureWidth(frame), place = pixel.x / width;  // places of reflections lie side by side (gloss_points.glsl)
  pixel.x += place * (kNearFieldBlockX - width % kNearFieldBlockX);
#endif
  return pixel / ivec2(kNearFieldBlockX, kNearFieldBlockY);
}

/// What the pool sends to a point, before any ray; besides, what it sends that was asked about already, and what of that
/// arrives.
void begin(uint point, vec3 light, vec3 asked, vec3 known, float foldsWithin) {
  shadowPoints[point].light = vec4(light + asked, -1.0);
  shadowPoints[point].asked = vec4(asked, foldsWithin);
  shadowPoints[point].known = vec4(known, 0.0);
  shadowPoints[point].all = vec4(0.0);
  shadowPoints[point].seen = vec4(0.0);
  shadowPoints[point].sum.a = 0.0;
}
