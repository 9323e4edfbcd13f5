// Linear radiance to display values, by the exposure that exposure.comp found.
#include "layout.h"
#include "common/tonemap.glsl"

layout(binding = kRadiance) uniform sampler2D radiance;
layout(std430, binding = kExposure) readonly buffer Exposure { vec4 exposure; };

layout(location = 0) out vec4 colour;

void main() {
  colour = vec4(displayFromRadiance(texelFetch(radiance, ivec2(gl_FragCoord.xy), 0).rgb, exposure.x), 1.0);
}
