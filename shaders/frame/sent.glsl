// What a part of a pixel shows of a surface whose light is known. LPV_GLOSS: surfaces have lobes (frame/gloss.glsl); LPV_HAZE:
// some of it is lost in haze, which shines itself (frame/haze.comp). Lobe and shine are those of the pixel that the part is most like.
#include "common/sh.glsl"

#ifndef LPV_GLOSS
#error "LPV_GLOSS: 0 or 1"
#elif LPV_GLOSS
layout(binding = kGloss) uniform sampler2D gloss;
#endif
#ifndef LPV_HAZE
#error "LPV_HAZE: 0 or 1"
#elif LPV_HAZE
#include "visibility/haze.glsl"
layout(binding = kHaze) uniform sampler2D haze;
#endif

/// `code`: of the pixel that it is most like, of those around `pixel`, or kNoPixel; `place`: in the grid. The shine of haze
/// before `pixel` itself is left out: it is added to all that it shows.
vec3 sent(FrameParams frame, ivec2 pixel, int code, vec3 place, vec3 albedo, vec3 irradiance) {
  vec3 light = albedo * irradiance / kPi;
  const ivec2 like = pixel + pixelAround(code == kNoPixel ? kOwnPixel : code);
#if LPV_GLOSS
  if (code != kNoPixel) {
    const vec4 lobe = texelFetch(gloss, like, 0);
    light = lobe.rgb + lobe.a * light;
  }
#endif
#if LPV_HAZE
  light *= throughHaze(place, frame.eye);
  if (code != kNoPixel) light += texelFetch(haze, like, 0).rgb - texelFetch(haze, pixel, 0).rgb;
#endif
  return light;
}
