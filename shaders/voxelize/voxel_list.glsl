// The list of a light's cells, or with LPV_VPLS of the table's entries that hold a VPL. Its header is also an indirect
// dispatch over what is listed.
layout(std430, binding = kVoxelCells) buffer Voxels { VoxelHeader voxelHeader; uvec2 voxels[]; };

#ifdef LPV_DEPOSIT

/// `count` more in a list of which every kCellGroup-th adds a group to later dispatches; the first group is always there,
/// since it also counts triangles without area. The number of the first.
uint appendToList(uint count) {
  const uint slot = atomicAdd(voxelHeader.count, count);
  const uint groups = (slot + count - 1u) / uint(kCellGroup) - (max(slot, 1u) - 1u) / uint(kCellGroup);
  if (groups > 0u) atomicAdd(voxelHeader.groupsX, groups);
  return slot;
}

/// A place in the list. All threads come here at once and wait for one number: those that run in step ask together.
uint nextInList() {
#ifdef LPV_BALLOT
  const uint64_t together = ballotARB(true);
  const uvec2 askers = unpackUint2x32(together), before = unpackUint2x32(together & gl_SubGroupLtMaskARB);
  const uint rank = uint(bitCount(before.x) + bitCount(before.y));
  uint slot = 0u;
  if (rank == 0u) slot = appendToList(uint(bitCount(askers.x) + bitCount(askers.y)));
  return readFirstInvocationARB(slot) + rank;
#else
  return appendToList(1u);
#endif
}

#endif
