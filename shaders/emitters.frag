// Radiance of the nearest light: the front's, or the back's (black unless two-sided).
#include "layout.h"

layout(std140, binding = kDrawParams) uniform DrawBlock { DrawParams draw; };

layout(location = 0) out vec4 emission;

void main() { emission = vec4(gl_FrontFacing ? draw.colour.rgb : draw.backColour.rgb, 1.0); }
