// Light meshes, to be seen themselves.
#include "layout.h"

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };

layout(location = kPositionAttribute) in vec3 position;
layout(location = kUvAttribute) in vec2 uv;

out vec2 textureUv;

const float kDepthOfDistant = 1e-20;  // reversed: behind all that is drawn, before nothing

void main() {
  textureUv = uv;
  gl_Position = frame.clipFromEye * (draw.eyeFromObject * vec4(position, 1.0));
  if (draw.atInfinity > 0.0) gl_Position.z = kDepthOfDistant * gl_Position.w;
}
