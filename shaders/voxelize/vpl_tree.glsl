// The tree over one light's VPLs (MATHS.md 3b.2): blocks of 1, 2, 4 .. cells, aligned to the grid's origin, up to one
// that holds the light. Every block of the light's box has a node, occupied or not; level after level, in each x fastest.
#include "layout.h"

layout(std140, binding = kParams) uniform Block { TreeParams params; };

/// What the walk over occupied nodes needs, and what numbers them. Entries are numbered depth first: a node's own, then
/// its children's.
struct Node {
  uvec2 bins;    // which normal bins hold light
  uint entries;  // of the node and all below it; 0: empty
  uint first;    // its first entry
};
layout(std430, binding = kTreeNodes) buffer Nodes { uvec4 nodes[]; };

Node nodeAt(int index) { return Node(nodes[index].xy, nodes[index].z, nodes[index].w); }

uint binsIn(uvec2 bins) { return uint(bitCount(bins.x) + bitCount(bins.y)); }

/// Place of a bin among those that hold light.
uint placeOf(uvec2 bins, uint bin) {
  const uint low = bin < 32u ? bins.x & ((1u << bin) - 1u) : bins.x;
  const uint high = bin < 32u ? 0u : bins.y & ((1u << (bin - 32u)) - 1u);
  return uint(bitCount(low) + bitCount(high));
}

bool hasBin(uvec2 bins, uint bin) { return ((bin < 32u ? bins.x >> bin : bins.y >> (bin - 32u)) & 1u) != 0u; }

ivec3 levelLower(int level) { return params.lower >> level; }
ivec3 levelSize(int level) { return ((params.upper - 1) >> level) - levelLower(level) + 1; }
int levelOffset(int level) { return int(params.nodesBefore[level / 4][level % 4]); }

int nodeIndex(int level, ivec3 block) {
  const ivec3 size = levelSize(level), at = block - levelLower(level);
  return levelOffset(level) + (at.z * size.y + at.y) * size.x + at.x;
}

/// The block of node number `i` of a level; false beyond its last.
bool blockOf(int level, int i, out ivec3 block) {
  const ivec3 size = levelSize(level);
  block = levelLower(level) + ivec3(i % size.x, (i / size.x) % size.y, i / (size.x * size.y));
  return i < size.x * size.y * size.z;
}

/// Number `i` of a block's 8 children; false where the light's box ends.
bool childOf(int level, ivec3 block, int i, out ivec3 child) {
  child = 2 * block + ivec3(i & 1, (i >> 1) & 1, i >> 2);
  const ivec3 lower = levelLower(level - 1), upper = lower + levelSize(level - 1);
  return all(greaterThanEqual(child, lower)) && all(lessThan(child, upper));
}

/// Whether a node says no more than its only child does: it has no entries of its own then.
bool isSingleChild(uint childrenWithLight) { return childrenWithLight == 1u; }
