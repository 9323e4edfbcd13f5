// A pixel that was buried (frame/buried.comp), as a point of the G-buffer's depth. A vertex has a place of the list, which
// may be empty.
#include "layout.h"

layout(std140, binding = kBuriedParams) uniform BuriedBlock { BuriedParams params; };
layout(binding = kBuriedList) uniform samplerBuffer list;

void main() {
  const int count = int(min(floatBitsToUint(texelFetch(list, 0).x), uint(params.most)));
  gl_PointSize = 1.0;
  gl_Position = vec4(2.0, 2.0, 0.0, 1.0);  // outside
  if (gl_VertexID >= count) return;
  const vec4 place = texelFetch(list, 1 + gl_VertexID);
  const vec2 middle = 2.0 * (place.xy + 0.5) * params.pixelSize - 1.0;
  gl_Position = vec4(middle.x, -middle.y, place.z, 1.0);
}
