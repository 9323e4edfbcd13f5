// Listing the points of a block of pixels that are to be evaluated (frame/near_field.comp, frame/gloss_rays.comp).

layout(std430, binding = kNearFieldPoints) buffer Points {
  ListHeader list;  // a thread per four points
  uvec4 points[];   // packedPixel()
};

/// The lowest bit's point of the block, which is taken off.
uint takePoint(inout uint bits, ivec2 corner, ivec2 spacing) {
  const int point = findLSB(bits);
  bits &= bits - 1u;
  return packedPixel(corner + spacing * ivec2(point % kNearFieldBlockX, point / kNearFieldBlockX));
}

/// Lists the points of a block in fours; the last one may be listed more than once.
void listPoints(uint bits, ivec2 corner, ivec2 spacing) {
  const uint fours = uint(bitCount(bits) + 3) / 4u;
  if (fours == 0u) return;
  const uint first = atomicAdd(list.count, fours);
  atomicMax(list.groupsX, (first + fours + kNearFieldGroup - 1u) / kNearFieldGroup);
  for (uint i = 0u; i < fours; ++i) {
    uvec4 four = uvec4(takePoint(bits, corner, spacing));
    for (int k = 1; k < 4; ++k) four[k] = bits != 0u ? takePoint(bits, corner, spacing) : four[k - 1];
    points[first + i] = four;
  }
}
