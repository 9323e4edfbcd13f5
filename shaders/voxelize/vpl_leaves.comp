// The table's VPLs to where they belong; the table is left empty. A thread per VPL.
#include "voxelize/vpl_pass.glsl"
#include "voxelize/vpl_entries.glsl"

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
  v.position = params.origin + params.cell * (vec3(cell) + (weight > 0.0 ? clamp(moment / weight, 0.0, 1.0) : vec3(0.5)));
  v.area *= params.areaScale;
  v.direction *= params.areaScale;
  const float face = params.cell * params.cell;
  v.positionCovariance = face * covarianceInCell(v.area, v.direction);
  v.area *= face;
  v.direction *= face;
  v.spread = spreadOf(v.area, v.direction);
  const Node node = nodeAt(nodeIndex(0, cell));
  storeVpl(node.first + 1u + placeOf(node.bins, key & ((1u << kBinBits) - 1u)), v);
}
