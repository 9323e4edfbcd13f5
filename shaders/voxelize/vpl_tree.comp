// A light's tree out of its table of VPLs (shaders/voxelize/deposit.glsl), in five passes. All sums are of integers or in a fixed
// order: the same bits on every run.
//
// LPV_UP:     a level's nodes from their children's: bins, number of records. The leaves' bins are there already.
// LPV_DOWN:   where a level's nodes have their records, from where their parents have theirs; and their headers.
// LPV_LEAVES: the table's VPLs to where they belong; the table is left empty.
// LPV_MERGE:  a level's VPLs out of their children's.
#include "voxelize/vpl_tree.glsl"
#include "transport/vpls.glsl"
#include "voxelize/vpl_table.glsl"

layout(local_size_x = kNodeGroup) in;

/// Of the whole pass: a large one comes in several dispatches.
uint thread() { return params.firstThread + gl_GlobalInvocationID.x; }

#if defined(LPV_DOWN) || defined(LPV_LEAVES) || defined(LPV_MERGE)
layout(std430, binding = kTreeRecords) buffer Records { vec4 records[]; };

void storeVpl(uint record, Vpl v) {
  const int at = int(record) * kRecordTexels;
  records[at] = vec4(v.position, v.area);
  records[at + 1] = vec4(v.direction, v.spread);
  const mat3 e = v.extent;
  records[at + 2] = vec4(e[0][0], e[1][1], e[2][2], e[0][0] + e[1][1] + e[2][2]);
  records[at + 3] = vec4(e[0][1], e[0][2], e[1][2], 0.0);
#if LPV_TEXTURED
  records[at + 4] = vec4(v.colour, 0.0);
#endif
}
#endif

#if defined(LPV_UP)

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
      below += node.records;
      lit += node.records > 0u ? 1u : 0u;
    }
  }
  const uint own = bins == uvec2(0u) || isSingleChild(lit) ? 0u : 1u + binsIn(bins);
  nodes[self] = uvec4(bins, own + below, 0u);
  if (level + 1 == params.levels) voxelHeader.treeEntries = own + below;
}

#elif defined(LPV_DOWN)

void storeHeader(int level, ivec3 block, Node node) {
  const int at = int(node.first) * kRecordTexels;
  const float edge = float(1 << level);
  records[at] = vec4((vec3(block) + 0.5) * edge, edge);
  records[at + 1] = vec4(float(binsIn(node.bins)), float(node.first + node.records), 0.0, 0.0);
  for (int i = 2; i < kRecordTexels; ++i) records[at + i] = vec4(0.0);
}

void main() {
  const int level = params.level;
  ivec3 block;
  if (!blockOf(level, int(thread()), block)) return;
  const int self = nodeIndex(level, block);
  Node node = nodeAt(self);
  if (node.records == 0u) return;
  if (level + 1 == params.levels) nodes[self].w = node.first = 0u;
  uint lit = 0u, below = 0u;
  if (level > 0) {
    for (int i = 0; i < 8; ++i) {
      ivec3 child;
      if (!childOf(level, block, i, child)) continue;
      const uint records_ = nodeAt(nodeIndex(level - 1, child)).records;
      below += records_;
      lit += records_ > 0u ? 1u : 0u;
    }
  }
  if (!isSingleChild(lit)) storeHeader(level, block, node);
  if (level == 0) return;
  uint first = node.first + node.records - below;
  for (int i = 0; i < 8; ++i) {
    ivec3 child;
    if (!childOf(level, block, i, child)) continue;
    const int at = nodeIndex(level - 1, child);
    nodes[at].w = first;
    first += nodeAt(at).records;
  }
}

#elif defined(LPV_LEAVES)

/// Fixed point of the table, as a share of the light's area; the table is left at zero.
float taken(int at) {
  uvec2 bits = uvec2(words[at], words[at + 1]);
  words[at] = words[at + 1] = 0u;
  const bool negative = bits.y >= 0x80000000u;
  if (negative) bits = uvec2(0u - bits.x, ~bits.y + (bits.x == 0u ? 1u : 0u));
  const float size = (float(bits.y) * 4294967296.0 + float(bits.x)) * float(params.shareOfUnit);
  return negative ? -size : size;
}

vec3 taken3(int at) { return vec3(taken(at), taken(at + kWideWords), taken(at + 2 * kWideWords)); }

void main() {
  if (thread() >= voxelHeader.count) return;
  const int base = int(voxels[thread()].x) * kVplWords;
  const uint key = words[base + kVplKey] - 1u;
  words[base + kVplKey] = 0u;
  Vpl v;
  v.area = taken(base + kVplArea);
  v.direction = taken3(base + kVplDirection);
  const vec3 moment = taken3(base + kVplOffset);
#if LPV_TEXTURED
  const vec3 colour = taken3(base + kVplColour);
  const float weight = taken(base + kVplWeight);
  v.colour = v.area > 0.0 ? colour / v.area : vec3(0.0);
#else
  const float weight = v.area;
#endif
  const ivec3 cell = params.lower + cellInBox(int(key >> kBinBits), params.upper - params.lower);
  v.position = vec3(cell) + (weight > 0.0 ? clamp(moment / weight, 0.0, 1.0) : vec3(0.5));
  v.area *= params.areaScale;
  v.direction *= params.areaScale;
  v.spread = spreadOf(v.area, v.direction);
  v.extent = extentInCell(v.area, v.direction);
  const Node node = nodeAt(nodeIndex(0, cell));
  storeVpl(node.first + 1u + placeOf(node.bins, key & ((1u << kBinBits) - 1u)), v);
}

#else

Vpl vplAt(uint record) {
  const int at = int(record) * kRecordTexels;
  Vpl v;
  v.position = records[at].xyz;
  v.area = records[at].w;
  v.direction = records[at + 1].xyz;
  v.spread = records[at + 1].w;
  const vec3 d = records[at + 2].xyz, o = records[at + 3].xyz;
  v.extent = mat3(d.x, o.x, o.y, o.x, d.y, o.z, o.y, o.z, d.z);
#if LPV_TEXTURED
  v.colour = records[at + 4].rgb;
#endif
  return v;
}

/// One of a node's children's VPLs; false where that child has none of this bin.
bool childsVpl(int level, ivec3 block, int i, uint bin, out Vpl v) {
  ivec3 child;
  if (!childOf(level, block, i, child)) return false;
  const Node node = nodeAt(nodeIndex(level - 1, child));
  if (!hasBin(node.bins, bin)) return false;
  v = vplAt(node.first + 1u + placeOf(node.bins, bin));
  return true;
}

/// What places count by: what is sent out from them.
float weightOf(Vpl v) {
#if LPV_TEXTURED
  return v.area * max(v.colour.r, max(v.colour.g, v.colour.b));
#else
  return v.area;
#endif
}

/// The children's VPLs of one bin as one.
Vpl merged(int level, ivec3 block, uint bin) {
  Vpl sum, v;
  sum.position = sum.direction = sum.colour = vec3(0.0);
  sum.area = 0.0;
  sum.extent = mat3(0.0);
  float weights = 0.0;
  const vec3 from = (vec3(block) + 0.5) * float(1 << level);
  for (int i = 0; i < 8; ++i) {
    if (!childsVpl(level, block, i, bin, v)) continue;
    sum.area += v.area;
    sum.direction += v.direction;
#if LPV_TEXTURED
    sum.colour += v.area * v.colour;
#endif
    sum.position += weightOf(v) * (v.position - from);
    weights += weightOf(v);
  }
  sum.position = from + (weights > 0.0 ? sum.position / weights : vec3(0.0));
  for (int i = 0; i < 8; ++i) {
    if (weights == 0.0 || !childsVpl(level, block, i, bin, v)) continue;
    const vec3 away = v.position - sum.position;
    sum.extent += weightOf(v) / weights * (v.extent + outerProduct(away, away));
  }
#if LPV_TEXTURED
  sum.colour = sum.area > 0.0 ? sum.colour / sum.area : vec3(0.0);
#endif
  sum.spread = spreadOf(sum.area, sum.direction);
  return sum;
}

uint childrenWithLight(int level, ivec3 block) {
  uint lit = 0u;
  for (int i = 0; i < 8; ++i) {
    ivec3 child;
    if (childOf(level, block, i, child) && nodeAt(nodeIndex(level - 1, child)).records > 0u) lit++;
  }
  return lit;
}

void main() {
  const int level = params.level;
  ivec3 block;
  if (!blockOf(level, int(thread()), block)) return;
  const Node node = nodeAt(nodeIndex(level, block));
  if (node.records == 0u || isSingleChild(childrenWithLight(level, block))) return;
  uint record = node.first + 1u;
  for (uint bin = 0u; bin < uint(kNormalBins); ++bin) {
    if (hasBin(node.bins, bin)) storeVpl(record++, merged(level, block, bin));
  }
}

#endif
