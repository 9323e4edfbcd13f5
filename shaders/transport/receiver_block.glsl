// Blocks of receivers as lists of them have them; the inverse of packedBlock().

ivec3 firstCellOf(uint block) {
  const uint mask = (1u << kBlockBits) - 1u;
  return ivec3(block & mask, (block >> kBlockBits) & mask, block >> (2 * kBlockBits)) * ivec3(kBlockX, kBlockY, kBlockZ);
}
