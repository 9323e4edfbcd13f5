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

#if LPV_SQUARES
/// From squares about the cell's lower corner and their weight.
mat3 covarianceOf(vec3 on, vec3 off, float weight, vec3 middle) {
  if (!(weight > 0.0)) return mat3(0.0);
  const vec3 m = middle;
  const vec3 variance = max(on / weight - m * m, 0.0);
  // Rounding must not give two axes more in common than they have.
  const vec3 most = sqrt(vec3(variance.x * variance.y, variance.x * variance.z, variance.y * variance.z));
  const vec3 c = clamp(off / weight - vec3(m.x * m.y, m.x * m.z, m.y * m.z), -most, most);
  return mat3(variance.x, c.x, c.y, c.x, variance.y, c.z, c.y, c.z, variance.z);
}
#endif

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
  const vec3 middle = weight > 0.0 ? clamp(moment / weight, 0.0, 1.0) : vec3(0.5);
  v.position = vec3(cell) + middle;
  v.area *= params.areaScale;
  v.direction *= params.areaScale;
  v.spread = spreadOf(v.area, v.direction);
#if LPV_SQUARES
  const vec3 on = taken3(base + kVplSquares), off = taken3(base + kVplSquares + 3 * kWideWords);
  v.positionCovariance = covarianceOf(on, off, weight, middle);
#else
  v.positionCovariance = covarianceInCell(v.area, v.direction);
#endif
  const Node node = nodeAt(nodeIndex(0, cell));
  storeVpl(node.first + 1u + placeOf(node.bins, key & ((1u << kBinBits) - 1u)), v);
}
