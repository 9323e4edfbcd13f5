// Bins and number of entries of a level's nodes, from their children's; the leaves' bins are there already. A thread per
// node.
#include "voxelize/vpl_pass.glsl"

void main() {
  const int level = params.level;
  ivec3 block;
  if (!blockOf(level, int(thread()), block)) return;
  const int self = nodeIndex(level, block);
  uvec2 bins = uvec2(0u);
  uint below = 0u, lit = 0u;
  if (level == 0) {
    bins = nodes[self].xy;
    if (bins != uvec2(0u)) atomicAdd(voxelHeader.litCells, 1u);
  } else {
    for (int i = 0; i < 8; ++i) {
      ivec3 child;
      if (!childOf(level, block, i, child)) continue;
      const Node node = nodeAt(nodeIndex(level - 1, child));
      bins |= node.bins;
      below += node.entries;
      lit += node.entries > 0u ? 1u : 0u;
    }
  }
  const uint own = bins == uvec2(0u) || isSingleChild(lit) ? 0u : 1u + binsIn(bins);
  nodes[self] = uvec4(bins, own + below, 0u);
  if (level + 1 == params.levels) voxelHeader.treeEntries = own + below;
}
