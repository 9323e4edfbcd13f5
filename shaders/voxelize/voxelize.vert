// The raster injector's first stage: vertices are fetched where they are needed, so only the triangle's index goes on.
#include "layout.h"

layout(std140, binding = kParams) uniform Block { VoxelizeParams params; };

flat out uint vertexTriangle;

void main() {
  vertexTriangle = params.firstTriangle + uint(gl_VertexID) / 3u;
  gl_Position = vec4(0.0, 0.0, 0.0, 1.0);
}
