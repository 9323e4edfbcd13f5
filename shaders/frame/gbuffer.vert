// Surfaces into the G-buffer.
#include "layout.h"

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };

layout(location = kPositionAttribute) in vec3 position;
layout(location = kNormalAttribute) in vec3 normal;
layout(location = kUvAttribute) in vec2 uv;

out vec3 eyePosition;  // metres from the eye, world axes
out vec3 worldNormal;
out vec2 textureUv;

void main() {
  const vec4 eye = draw.eyeFromObject * vec4(position, 1.0);
  eyePosition = eye.xyz;
  worldNormal = mat3(draw.normalFromObject) * normal;
  textureUv = uv;
  gl_Position = frame.clipFromEye * eye;
}
