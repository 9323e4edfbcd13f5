// Albedo and normal of the nearest surface. The normal is the interpolated vertex normal (LPV_NORMALS), else the
// triangle's; seen from behind it is turned over, towards the viewer. LPV_ALPHA: the texture's alpha says what is there.
#include "layout.h"
#include "common/anisotropic.glsl"
#include "common/octahedral.glsl"

#if !defined(LPV_NORMALS) || !defined(LPV_TEXTURE) || !defined(LPV_ALPHA)
#error "LPV_NORMALS, LPV_TEXTURE, LPV_ALPHA: 0 or 1"
#endif

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };
#if LPV_TEXTURE
layout(binding = kAlbedo) uniform sampler2D albedoTexture;
#endif

in vec3 eyePosition;
in vec3 worldNormal;
in vec2 textureUv;

layout(location = 0) out vec4 albedo;
layout(location = 1) out vec2 normal;

/// Of any length.
vec3 surfaceNormal() {
#if LPV_NORMALS
  return gl_FrontFacing ? worldNormal : -worldNormal;
#else
  const vec3 n = cross(dFdx(eyePosition), dFdy(eyePosition));
  return dot(n, eyePosition) < 0.0 ? n : -n;
#endif
}

void main() {
  albedo = vec4(draw.colour, 1.0);
#if LPV_TEXTURE
  const vec4 texel = textureAskew(albedoTexture, textureUv, inversesqrt(float(frame.samples)));
  albedo.rgb *= texel.rgb;
#endif
#if LPV_ALPHA
  const float alpha = draw.opacity * texel.a;
  if (alpha < draw.leastAlpha) discard;
  albedo.rgb *= max(alpha, draw.masked);
#endif
  normal = octahedralFromDirection(surfaceNormal());
}
