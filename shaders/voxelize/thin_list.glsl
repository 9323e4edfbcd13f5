// Triangles that snapping makes a segment over several cells: thin.comp, a work-group each.
layout(std430, binding = kThinTriangles) buffer Thin { ListHeader thinHeader; uint thin[]; };

void handOnThin(uint triangle) {
  const uint slot = atomicAdd(thinHeader.count, 1u);
  atomicAdd(thinHeader.groupsX, 1u);
  thin[slot] = triangle;
}
