// What lies behind a pane keeps (1 - alpha) x transmission of its radiance, where the G-buffer does not show the surface.
// Panes multiply, in any order; those behind what is seen do nothing.
#include "layout.h"

#ifndef LPV_ALPHA
#error "LPV_ALPHA: 0 or 1"
#endif

layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };
#if LPV_ALPHA
layout(binding = kAlbedo) uniform sampler2D albedoTexture;
in vec2 textureUv;
#endif
layout(binding = kSurfaceDepth) uniform sampler2D surfaceDepth;
layout(binding = kEmitterDepth) uniform sampler2D emitterDepth;

layout(location = 0) out vec4 share;

void main() {
  float alpha = draw.opacity;
#if LPV_ALPHA
  alpha *= texture(albedoTexture, textureUv).a;
#endif
  const ivec2 pixel = ivec2(gl_FragCoord.xy);
  const float seen = max(texelFetch(surfaceDepth, pixel, 0).x, texelFetch(emitterDepth, pixel, 0).x);
  if (alpha >= draw.leastAlpha || gl_FragCoord.z <= seen) discard;  // reversed depth: larger is nearer
  share = vec4((draw.masked == 1.0 ? 1.0 : 1.0 - alpha) * draw.transmission, 1.0);
}
