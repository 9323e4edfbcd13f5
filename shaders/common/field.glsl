// Where a cell's coefficients are. Fields carry a halo of one zero cell on every side, so that a neighbour outside the
// grid reads zero without a test: channel by channel, x fastest, then y, then z.

int haloIndex(ivec3 cell, ivec3 dims, int channel) {
  const ivec3 h = dims + 2;
  return ((channel * h.z + cell.z + 1) * h.y + cell.y + 1) * h.x + cell.x + 1;
}

int cellIndex(ivec3 cell, ivec3 dims) { return (cell.z * dims.y + cell.y) * dims.x + cell.x; }

ivec3 cellOfIndex(int index, ivec3 dims) {
  return ivec3(index % dims.x, (index / dims.x) % dims.y, index / (dims.x * dims.y));
}
