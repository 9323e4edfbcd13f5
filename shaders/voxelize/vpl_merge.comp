// A level's VPLs out of their children's. A thread per node.
#include "voxelize/vpl_pass.glsl"
#include "voxelize/vpl_entries.glsl"

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
  sum.positionCovariance = mat3(0.0);
  float weights = 0.0;
  const vec3 from = centreOf(level, block);
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
    sum.positionCovariance += weightOf(v) / weights * (v.positionCovariance + outerProduct(away, away));
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
    if (childOf(level, block, i, child) && nodeAt(nodeIndex(level - 1, child)).entries > 0u) lit++;
  }
  return lit;
}

void main() {
  const int level = params.level;
  ivec3 block;
  if (!blockOf(level, int(thread()), block)) return;
  const Node node = nodeAt(nodeIndex(level, block));
  if (node.entries == 0u || isSingleChild(childrenWithLight(level, block))) return;
  uint entry = node.first + 1u;
  for (uint bin = 0u; bin < uint(kNormalBins); ++bin) {
    if (hasBin(node.bins, bin)) storeVpl(entry++, merged(level, block, bin));
  }
}
