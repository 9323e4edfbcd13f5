// The raster injector's last stage: a fragment is a column of cells, of which at most three can make a pair with the
// triangle (paper 3.1; MATHS.md 7 on why not two).
#include "voxelize/voxelize.glsl"

flat in uint triangle;

void main() {
  EmittingTriangle e;
  if (!loadTriangle(triangle, e)) return;
  const ivec2 column = ivec2(gl_FragCoord.xy);
  if (any(lessThan(column, e.lattice.lower.xy)) || any(greaterThan(column, e.lattice.upper.xy))) return;
  voxelizeColumn(e, column);
}
