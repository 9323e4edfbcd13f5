// Where a level's nodes have their entries, from where their parents have theirs; and their headers. A thread per node.
#include "voxelize/vpl_pass.glsl"
#include "voxelize/vpl_entries.glsl"

void storeHeader(int level, ivec3 block, Node node) {
  const int at = int(node.first) * kEntryTexels;
  const float size = LPV_TEXTURED == 1 ? kColouredSize : 1.0;
  entries[at] = vec4(centreOf(level, block), size * params.cell * float(1 << level));
  entries[at + 1] = vec4(float(binsIn(node.bins)), float(node.first + node.entries), 0.0, 0.0);
  for (int i = 2; i < kEntryTexels; ++i) entries[at + i] = vec4(0.0);
}

void main() {
  const int level = params.level;
  ivec3 block;
  if (!blockOf(level, int(thread()), block)) return;
  const int self = nodeIndex(level, block);
  Node node = nodeAt(self);
  if (node.entries == 0u) return;
  if (level + 1 == params.levels) nodes[self].w = node.first = 0u;
  uint lit = 0u, below = 0u;
  if (level > 0) {
    for (int i = 0; i < 8; ++i) {
      ivec3 child;
      if (!childOf(level, block, i, child)) continue;
      const uint childEntries = nodeAt(nodeIndex(level - 1, child)).entries;
      below += childEntries;
      lit += childEntries > 0u ? 1u : 0u;
    }
  }
  if (!isSingleChild(lit)) storeHeader(level, block, node);
  if (level == 0) return;
  uint first = node.first + node.entries - below;
  for (int i = 0; i < 8; ++i) {
    ivec3 child;
    if (!childOf(level, block, i, child)) continue;
    const int at = nodeIndex(level - 1, child);
    nodes[at].w = first;
    first += nodeAt(at).entries;
  }
}
