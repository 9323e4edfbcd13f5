// Light meshes, to be seen themselves.
#include "layout.h"

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };

layout(location = kPositionAttribute) in vec3 position;
layout(location = kUvAttribute) in vec2 uv;

out vec2 textureUv;

void main() {
  textureUv = uv;
  gl_Position = frame.clipFromEye * (draw.eyeFromObject * vec4(position, 1.0));
}
