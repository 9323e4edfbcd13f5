// The list of a light's cells, or with LPV_VPLS of the table's entries that hold a VPL. Its header is also an indirect
// dispatch over what is listed.
layout(std430, binding = kVoxelCells) buffer Voxels { VoxelHeader voxelHeader; uvec2 voxels[]; };

#ifdef LPV_DEPOSIT

/// A place in the list. Every kCellGroup-th adds a group to later dispatches; the first group is always there, since it
/// also counts triangles without area.
uint nextInList() {
  const uint slot = atomicAdd(voxelHeader.count, 1u);
  if (slot > 0u && slot % uint(kCellGroup) == 0u) atomicAdd(voxelHeader.groupsX, 1u);
  return slot;
}

#endif
