// Radiance of the nearest light: the front's, or the back's (black unless two-sided), times the texture.
#include "layout.h"

#ifndef LPV_TEXTURE
#error "LPV_TEXTURE: 0 or 1"
#endif

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };
#if LPV_TEXTURE
layout(binding = kAlbedo) uniform sampler2D radianceTexture;
in vec2 textureUv;
#endif

layout(location = 0) out vec4 emission;

void main() {
  emission = vec4(gl_FrontFacing ? draw.colour : draw.backColour, 1.0);
#if LPV_TEXTURE
  emission.rgb *= texture(radianceTexture, textureUv, -0.5 * log2(float(frame.samples))).rgb;
#endif
}
