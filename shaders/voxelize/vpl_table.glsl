// The table in which FLUX merges what falls into one cell and normal bin (MATHS.md 3b.1): open addressing, so that its
// size follows from the VPLs there are, not from the cells. Where a VPL lies in it depends on the order of arrival; its
// sums, and the order that the tree gives it, do not.
//
// Words of an entry: shaders/layout.h.

// LPV_SQUARES: second moments of where a VPL emits are kept, for textured lights and thin ones. Else what is in one cell
// is taken for a flat square: its own second moments are not worth their place in the table.
#ifndef LPV_SQUARES
#error "LPV_SQUARES: 0 or 1"
#endif

#if LPV_TEXTURED
const int kVplSquares = kTexturedVplWords;
#else
const int kVplSquares = kPlainVplWords;
#endif
const int kVplWords = kVplSquares + LPV_SQUARES * kSquareWords;

layout(std430, binding = kAccumulators) buffer Table { uint words[]; };
#include "voxelize/voxel_list.glsl"

ivec3 cellInBox(int index, ivec3 size) { return ivec3(index % size.x, (index / size.x) % size.y, index / (size.x * size.y)); }

#ifdef LPV_DEPOSIT

layout(std430, binding = kTreeNodes) buffer Nodes { uint nodeWords[]; };

uint mixed(uint x) {  // fmix32 of MurmurHash3
  x ^= x >> 16;
  x *= 0x85EBCA6Bu;
  x ^= x >> 13;
  x *= 0xC2B2AE35u;
  return x ^ (x >> 16);
}

/// First word of the entry of a cell and bin, made where there is none; -1, counted, when the table is too full.
int vplPlace(ivec3 cell, int bin) {
  const ivec3 at = cell - params.boxLower, size = params.boxSize;
  const int leaf = (at.z * size.y + at.y) * size.x + at.x;
  const uint key = ((uint(leaf) << kBinBits) | uint(bin)) + 1u;
  const uint last = params.tableEntries - 1u;
  uint entry = mixed(key) & last;
  for (int probe = 0; probe < kMostProbes; ++probe) {
    const int base = int(entry) * kVplWords;
    const uint found = atomicCompSwap(words[base + kVplKey], 0u, key);
    if (found == key) return base;
    if (found == 0u) {
      voxels[nextInList()].x = entry;
      atomicOr(nodeWords[4 * leaf + bin / 32], 1u << (bin % 32));
      return base;
    }
    entry = (entry + 1u) & last;
  }
  atomicAdd(voxelHeader.lost, 1u);
  return -1;
}

#endif
