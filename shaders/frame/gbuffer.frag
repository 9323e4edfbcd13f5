// Albedo and normal of the nearest surface. The normal is the interpolated vertex normal (LPV_NORMALS), else the
// triangle's; seen from behind it is turned over, towards the viewer. LPV_ALPHA: the texture's alpha says what is there.
// LPV_NORMAL_MAP: a picture of tangent-space normals bends it. LPV_GLOSS: what its lobe follows from is kept;
// LPV_GLOSS_MAP: a picture multiplies that.
#include "layout.h"
#include "common/anisotropic.glsl"
#include "common/octahedral.glsl"

#if !defined(LPV_NORMALS) || !defined(LPV_TEXTURE) || !defined(LPV_ALPHA) || !defined(LPV_NORMAL_MAP)
#error "LPV_NORMALS, LPV_TEXTURE, LPV_ALPHA, LPV_NORMAL_MAP: 0 or 1"
#endif
#if !defined(LPV_GLOSS) || !defined(LPV_GLOSS_MAP)
#error "LPV_GLOSS, LPV_GLOSS_MAP: 0 or 1"
#endif

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };
#if LPV_TEXTURE
layout(binding = kAlbedo) uniform sampler2D albedoTexture;
#endif

#if LPV_NORMAL_MAP
layout(binding = kNormal) uniform sampler2D normalMap;
#endif
#if LPV_GLOSS_MAP
layout(binding = kGlossMap) uniform sampler2D glossMap;
#endif

in vec3 eyePosition;
in vec3 worldNormal;
in vec2 textureUv;

layout(location = 0) out vec4 albedo;
layout(location = 1) out vec2 normal;
#if LPV_GLOSS
layout(location = 2) out vec2 material;  // roughness, metalness
#endif

/// Of any length.
vec3 surfaceNormal() {
#if LPV_NORMALS
  return gl_FrontFacing ? worldNormal : -worldNormal;
#else
  const vec3 n = cross(dFdx(eyePosition), dFdy(eyePosition));
  return dot(n, eyePosition) < 0.0 ? n : -n;
#endif
}

#if LPV_NORMAL_MAP
/// `n`, unit, bent by the picture. Its right and up are found from how positions and uvs change from pixel to pixel
/// (Schueler 2013, Followup: Normal Mapping Without Precomputed Tangents); v points down.
vec3 bent(vec3 n, float share) {
  const vec3 px = dFdx(eyePosition), py = dFdy(eyePosition);
  const vec2 ux = dFdx(textureUv), uy = dFdy(textureUv);
  const vec3 across = cross(py, n), down = cross(n, px);
  const vec3 right = across * ux.x + down * uy.x, up = -(across * ux.y + down * uy.y);
  const float longest = max(dot(right, right), dot(up, up));
  if (longest <= 0.0) return n;
  const float side = (gl_FrontFacing ? 1.0 : -1.0) * sign(dot(px, across));
  const vec3 m = 2.0 * textureAskew(normalMap, textureUv, share).rgb - 1.0;
  const vec2 tilt = draw.normalScale * side * inversesqrt(longest) * m.xy;
  return right * tilt.x + up * tilt.y + n * m.z;
}
#endif

void main() {
  const float share = inversesqrt(float(frame.samples));
#if LPV_GLOSS
  material = vec2(draw.roughness, draw.metalness);
#if LPV_GLOSS_MAP
  material *= textureAskew(glossMap, textureUv, share).gb;
#endif
#endif
  albedo = vec4(draw.colour, 1.0);
#if LPV_TEXTURE
  const vec4 texel = textureAskew(albedoTexture, textureUv, share);
  albedo.rgb *= texel.rgb;
#endif
#if LPV_ALPHA
  const float alpha = draw.opacity * texel.a;
  if (alpha < draw.leastAlpha) discard;
  albedo.rgb *= max(alpha, draw.masked);
#endif
#if LPV_NORMAL_MAP
  normal = octahedralFromDirection(bent(normalize(surfaceNormal()), share));
#else
  normal = octahedralFromDirection(surfaceNormal());
#endif
}
