// Which of 54 bins a direction falls into: 3 x 3 on each face of a cube around it (MATHS.md 3b.1).

int third(float t) { return t < -1.0 / 3.0 ? 0 : t <= 1.0 / 3.0 ? 1 : 2; }

/// 0 .. kNormalBins - 1. Ties of the largest axis go to the lower one.
int normalBin(vec3 n) {
  const vec3 size = abs(n);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const float largest = size[axis];
  const float u = n[(axis + 1) % 3] / largest, v = n[(axis + 2) % 3] / largest;
  return (2 * axis + (n[axis] < 0.0 ? 1 : 0)) * 9 + third(v) * 3 + third(u);
}
