// The raster injector's second stage (paper 3.1): the triangle is turned to its dominant axis, one pixel per column of
// cells, and made larger so that the centre of every column it meets is covered (Hasselgren et al. 2005). Triangles for
// which that is delicate (slivers, and small ones, which have nothing to gain) are drawn as the box of their columns. It
// only has to be large enough: which cells make pairs is decided in the next stage. Segments go to thin.comp.
#include "voxelize/voxelize.glsl"
#include "voxelize/thin_list.glsl"

layout(triangles) in;
layout(triangle_strip, max_vertices = 4) out;

flat in uint vertexTriangle[];
flat out uint triangle;

const float kPadding = 0.02;        // pixels beyond half a column: more than the rasterizer's own snapping
const int kBoxColumns = 4;          // up to so many columns along an axis the box is drawn
const float kSharpest = 0.25;       // sine of the angle below which a corner would grow too far

void emitPixel(vec2 p) {
  const float edge = float(max(params.dims.x, max(params.dims.y, params.dims.z)));
  triangle = vertexTriangle[0];
  gl_Position = vec4(2.0 * p / edge - 1.0, 0.5, 1.0);
  EmitVertex();
}

void emitBox(vec2 lower, vec2 upper) {
  emitPixel(lower);
  emitPixel(vec2(upper.x, lower.y));
  emitPixel(vec2(lower.x, upper.y));
  emitPixel(upper);
  EndPrimitive();
}

/// The line beside edge p -> q on its outer side (to the right) that keeps every touched column's centre within:
/// xy . point = z.
vec3 movedOut(vec2 p, vec2 q) {
  const vec2 normal = vec2(q.y - p.y, p.x - q.x);
  return vec3(normal, dot(normal, p) + (0.5 + kPadding) * (abs(normal.x) + abs(normal.y)));
}

bool crossingOf(vec3 l, vec3 m, out vec2 p) {
  const float area = l.x * m.y - l.y * m.x;
  p = vec2(l.z * m.y - m.z * l.y, l.x * m.z - m.x * l.z) / area;
  return abs(area) > kSharpest * length(l.xy) * length(m.xy);
}

void emitTriangle(LatticeTriangle t) {
  const ivec2 columns = t.upper.xy - t.lower.xy + 1;
  const bool clockwise = t.normal.z < 0.0lf;
  const float units = float(kLatticeUnits);
  const vec2 a = vec2(t.v0.xy) / units, b = vec2(clockwise ? t.v2.xy : t.v1.xy) / units,
             c = vec2(clockwise ? t.v1.xy : t.v2.xy) / units;
  const vec3 ab = movedOut(a, b), bc = movedOut(b, c), ca = movedOut(c, a);
  vec2 p, q, r;
  if (min(columns.x, columns.y) <= kBoxColumns || !crossingOf(ca, ab, p) || !crossingOf(ab, bc, q) ||
      !crossingOf(bc, ca, r)) {
    emitBox(vec2(t.lower.xy), vec2(t.upper.xy + 1));
    return;
  }
  emitPixel(p);
  emitPixel(q);
  emitPixel(r);
  EndPrimitive();
}

void main() {
  EmittingTriangle e;
  if (!loadTriangle(vertexTriangle[0], e)) {
#ifndef LPV_RECORD_PAIRS
    atomicAdd(voxelHeader.degenerate, 1u);
#endif
    return;
  }
  if (columnCount(e.lattice) == 0) return;
  if (isThin(e.lattice)) handOnThin(e.index);
  else emitTriangle(e.lattice);
}
