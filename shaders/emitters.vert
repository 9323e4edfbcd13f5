// Light meshes, to be seen themselves.
#include "layout.h"

layout(std140, binding = kParams) uniform FrameBlock { FrameParams frame; };
layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };

layout(location = kPositionAttribute) in vec3 position;

void main() { gl_Position = frame.clipFromEye * (draw.eyeFromObject * vec4(position, 1.0)); }
